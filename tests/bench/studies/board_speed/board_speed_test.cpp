// What the command `board` measures, on a short recording; the command takes minutes for all of its
// cancels. Times are of the machine; counts are not.
#include "bench/studies/board_speed/board_speed.h"

#include <gtest/gtest.h>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {
namespace {

/// docs/wire_format.md: a header of 64 bytes and 512 samples of 4; and in 0.16 m of depth, at 1540
/// m/s, one after the other.
constexpr double kStickBytes = 64 + 512 * 4;
constexpr double kStream_mb_s = kStickBytes / (2 * 0.16 / 1540) / 1e6;

TEST(BoardSpeed, ReadsTheWholeRecordingInEachStage) {
  std::size_t done = 0, all = 0;
  const Throughput measured = measure_throughput(2, 1, [&](std::size_t parts, std::size_t of) {
    done = parts;
    all = of;
  });
  EXPECT_EQ(done, 8U);  // four stages, once for warming up
  EXPECT_EQ(all, 8U);
  EXPECT_EQ(measured.sticks,
            2 * static_cast<std::uint64_t>(hw::AcquisitionPlan({}, {}).sticks_per_volume()));
  // A configuration and an end for each volume.
  EXPECT_NEAR(static_cast<double>(measured.bytes),
              kStickBytes * static_cast<double>(measured.sticks),
              2000);
  EXPECT_NEAR(measured.stream_mb_s, kStream_mb_s, 0.01);
  ASSERT_EQ(measured.stages.size(), 4U);
  EXPECT_EQ(measured.stages.back().stage, "file, decoder, ring, program");
  for (const StageSpeed& stage : measured.stages) {
    EXPECT_GT(stage.mb_s.min, kStream_mb_s) << stage.stage;
    EXPECT_EQ(stage.mb_s.median, stage.mb_s.max) << "one run";
  }
}

TEST(BoardSpeed, CancelsAreInTheOrderOfTheirShares) {
  const CancelTimes times = measure_cancels(40, 1);
  EXPECT_EQ(times.cancels, 40);
  EXPECT_EQ(times.load_threads, 1);
  EXPECT_GT(times.p50_ms, 0);
  EXPECT_LE(times.p50_ms, times.p99_ms);
  EXPECT_LE(times.p99_ms, times.p999_ms);
  EXPECT_LE(times.p999_ms, times.max_ms);
  EXPECT_LT(times.max_ms, 5000) << "the thread waits for a stick, not for the end of the stream";
}

}  // namespace
}  // namespace wobblebench::bench
