// Acquisition through a board: the times that it reports, and when a recording's clock starts.
#include "bench/pipeline/acquire.h"

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "bench/pipeline/stick_sources.h"
#include "hw/recording/recorder.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

class Acquiring : public testing_support::FolderTest {
 protected:
  std::filesystem::path record(const hw::AcquisitionPlan& plan) const {
    const auto path = file("r.wbst");
    std::ofstream stream(path, std::ios::binary);
    sim::SimLink link(synthetic_sticks(plan, 1));
    hw::Recorder recorder(link, [&](auto bytes) {
      stream.write(reinterpret_cast<const char*>(bytes.data()), std::ptrdiff_t(bytes.size()));
    });
    static_cast<void>(recorder.run([] { return false; }));
    return path;
  }
};

/// Between the plan and the volume lies whatever the program does first, for as long as it takes.
TEST_F(Acquiring, ARecordingInRealTimeTakesItsTimeHoweverLateItIsAskedFor) {
  hw::AcquisitionOptions options;
  options.frames_per_volume = 12;
  options.samples_per_stick = 16;
  const hw::AcquisitionPlan plan({}, options);
  BoardConnection board(parse_board("file=" + record(plan).string() + ",pace=realtime"));
  PhantomCache cache;
  Progress progress;
  const Scene given = load_scene({}, {"phantom.name=sphere", "phantom.voxel_mm=2"});
  const ResolvedScene scene = board.resolve(given, cache, progress);
  EXPECT_TRUE(scene.subject()) << "the samples are simulated";
  std::this_thread::sleep_for(2 * plan.volume_duration());
  const auto asked = hw::HostClock::now();
  const Acquisition acquisition = board.acquire(scene);
  EXPECT_EQ(acquisition.volume.missing_sticks(), 0);
  const auto waited = hw::HostClock::now() - asked;
  // Sticks that came before the board was stopped need not come again.
  EXPECT_GE(waited, plan.volume_duration() * 3 / 4);
  EXPECT_GE(acquisition.transport_ms, 0.75 * to_milliseconds(plan.volume_duration()));
}

TEST_F(Acquiring, TheTransportOfASimulatedVolumeIsNeverNegative) {
  const Scene given = load_scene({},
                                 {"phantom.name=sphere",
                                  "phantom.voxel_mm=2",
                                  "acquisition.frames_per_volume=2",
                                  "acquisition.sticks_per_frame=64",
                                  "acquisition.samples_per_stick=512"});
  const ResolvedScene scene = resolve_scene(given, make_phantom(given.phantom));
  for (int i = 0; i < 30; ++i) {
    EXPECT_GE(acquire_simulated(scene).transport_ms, 0) << i;
  }
}

}  // namespace
}  // namespace wobblebench::bench
