// The array of IQ samples on disk: each stick in its place, cut to whole volumes.
#include "bench/pipeline/iq_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include "bench/exchange/files/npy.h"
#include "tests/support/bytes_of.h"
#include "tests/support/expect.h"
#include "tests/support/file_limit.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

using Iq = std::vector<std::complex<float>>;
using IqFileOnDisk = testing_support::FolderTest;

hw::AcquisitionPlan small_plan() {
  return {{},
          {.sticks_per_frame = 3,
           .samples_per_stick = 64,
           .frames_per_volume = 2,
           .volumes = 3,
           .motor = hw::MotorMode::alternating}};
}

/// Tells its volume, frame, line and sample.
Iq stick_of(const hw::StickIndex& index, std::uint64_t samples) {
  Iq iq;
  for (std::uint64_t i = 0; i < samples; ++i) {
    iq.emplace_back(static_cast<float>(100 * index.volume + 10 * index.frame + index.line),
                    static_cast<float>(i));
  }
  return iq;
}

/// In the order of acquisition, last to first: odd volumes begin with the last frame.
void write_all(IqFile& file, const hw::AcquisitionPlan& plan) {
  const auto sticks = static_cast<std::uint64_t>(3 * plan.sticks_per_volume());
  for (std::uint64_t sequence = sticks; sequence-- > 0;) {
    const hw::StickIndex index = plan.index(sequence);
    file.write(index, stick_of(index, iq_shape(plan, 1).back()));
  }
}

TEST_F(IqFileOnDisk, HoldsEachStickAtItsVolumeFrameAndLine) {
  const auto plan = small_plan();
  IqFile array(file("iq.npy"), plan);
  write_all(array, plan);
  array.finish(2);
  array.write({2, 0, 0}, stick_of({2, 0, 0}, iq_shape(plan, 1).back()));
  const IqShape shape = iq_shape(plan, 2);
  const std::string bytes = testing_support::bytes_of(file("iq.npy"));
  const std::string header = npy_header(shape, "c8");
  ASSERT_EQ(bytes.size(), header.size() + 2 * 2 * 3 * shape[3] * 8) << "two volumes and no more";
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  const char* at = bytes.data() + header.size();
  for (std::uint32_t volume = 0; volume < 2; ++volume) {
    for (std::uint32_t frame = 0; frame < 2; ++frame) {
      for (std::uint32_t line = 0; line < 3; ++line) {
        const Iq expected = stick_of({volume, frame, line}, shape[3]);
        EXPECT_EQ(std::memcmp(at, expected.data(), 8 * shape[3]), 0)
            << volume << " " << frame << " " << line;
        at += 8 * shape[3];
      }
    }
  }
}

TEST_F(IqFileOnDisk, AFullDiskIsAnErrorNowAndAtTheEnd) {
  const auto plan = small_plan();
  IqFile array(file("iq.npy"), plan);
  const testing_support::FileLimit limit(2000);
  EXPECT_THROW(write_all(array, plan), std::runtime_error);
  EXPECT_EQ(refusal_of<std::runtime_error>([&] { array.finish(1); }),
            file("iq.npy").string() + ": cannot be written: File too large");
}

TEST_F(IqFileOnDisk, ReplacesNoFile) {
  IqFile first(file("iq.npy"), small_plan());
  EXPECT_THROW(IqFile(file("iq.npy"), small_plan()), std::runtime_error);
}

}  // namespace
}  // namespace wobblebench::bench
