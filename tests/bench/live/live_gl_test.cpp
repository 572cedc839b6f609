// What the live page sets, and a stream that ends otherwise than it should.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/units.h"
#include "bench/live/live_pipeline.h"
#include "bench/live/live_renderer.h"
#include "hw/probe/polar_volume.h"
#include "phantoms/phantom.h"
#include "render/gl/context.h"
#include "render/renderer.h"
#include "sim/probe_simulator.h"
#include "tests/bench/cli/program_under_test.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::bench {
namespace {

using Live = InFolder;

/// A panel whose first stream is there.
class Panel : public LivePanel {
 public:
  explicit Panel(const fs::path& file,
                 const Words& settings = {},
                 const std::optional<phantoms::Phantom>& phantom = std::nullopt)
      : LivePanel({file, settings}, /*with_scan=*/true, "") {
    adopt(wanted(), resolve_scene(wanted().given, phantom));
  }
};

TEST_F(Live, ASceneFileThatIsEditedMeanwhileDoesNotChangeTheScan) {
  folder_.write("scene.toml", "[acquisition]\ndepth_mm = 150\n");
  Panel panel(at("scene.toml"));
  folder_.write("scene.toml", "[acquisition]\ndepth_mm = 120\n");
  panel.set({"render.view.yaw_deg=20"});
  EXPECT_FALSE(panel.is_scan_wanted());
  EXPECT_DOUBLE_EQ(panel.state()->scene.plan().acquisition().depth_m, 0.15);
}

TEST_F(Live, StatusSaysWhichSettingsCannotAct) {
  Panel panel("");
  EXPECT_EQ(panel.status()["idle"]["render.view.eye_distance_mm"],
            "render.view.projection = perspective");
  panel.set({"render.view.projection=perspective"});
  EXPECT_FALSE(panel.status()["idle"].contains("render.view.eye_distance_mm"));
}

TEST_F(Live, WhatIsSetWhileAScanIsRefusedStays) {
  Panel panel("");
  panel.set({"render.view.pitch_deg=10"});
  const auto before = panel.state();
  panel.set({"acquisition.depth_mm=140", "render.view.pitch_deg=5"});
  const WantedScene refused = panel.wanted();
  panel.set({"render.view.yaw_deg=33"});
  panel.revert(before, refused.settings, "no such scan");
  EXPECT_FALSE(panel.is_scan_wanted());
  const auto status = panel.status();
  EXPECT_EQ(status["why"], "no such scan");
  EXPECT_EQ(status["settings"], (Words{"render.view.pitch_deg=10", "render.view.yaw_deg=33"}));
  EXPECT_EQ(panel.state()->settings, status["settings"].get<Words>());
}

/// Wants all; calls `watch` where the thread of run() asks who is there.
class Viewer : public LiveServer {
 public:
  int port() const override { return 0; }
  void publish(Channel channel, LiveMessage) override {
    ++published[static_cast<std::size_t>(channel)];
  }
  bool is_wanted(Channel) const override { return true; }
  int viewers() const override {
    if (std::this_thread::get_id() == owner_) watch();
    return 1;
  }
  int of(Channel channel) const { return published[static_cast<std::size_t>(channel)]; }

  std::function<void()> watch;
  std::array<std::atomic<int>, kChannels> published{};

 private:
  const std::thread::id owner_ = std::this_thread::get_id();
};

struct Stream {
  Stream(const std::string& board, const Words& settings)
      : panel({{}, settings}, board == "sim", ""),
        pipeline(parse_board(board), {}, *context, cache, progress, panel) {
    pipeline.prepare();
  }

  std::unique_ptr<render::GlContext> context = render::make_context("auto");
  PhantomCache cache;
  Progress progress;
  LivePanel panel;
  LivePipeline pipeline;
};

const Words kSmall = words_of(
    "phantom.name=sphere phantom.voxel_mm=2 acquisition.volumes=2 acquisition.frames_per_volume=9 "
    "acquisition.sticks_per_frame=16 render.ray_casting.image_size=64");

hw::PolarVolume scanned(const ResolvedScene& scene) {
  const sim::ProbeSimulator simulator(*scene.subject(), scene.plan(), scene.simulation());
  const sim::SimulationOptions& options = simulator.options();
  auto volume = hw::PolarVolume::of_samples(scene.plan(), 0, options.output, simulator.volume(0));
  volume.log_compress(options.dynamic_range_db);
  return volume;
}

TEST_F(Live, ACoarsePictureComesFirstWhereRaysAreSlow) {
  const auto context = render::make_context("auto");
  Panel panel("", kSmall, phantoms::make_phantom({.name = "sphere", .voxel_m = 2e-3}));
  std::vector<SharedPicture> shown;
  LiveRenderer renderer(
      *context, panel, [&](SharedPicture picture) { shown.push_back(std::move(picture)); }, {}, 0);
  const auto volume = scanned(panel.state()->scene);
  int index = 0;
  for (const hw::PolarFrame& frame : volume.frames()) renderer.add_frame(index++, frame);
  renderer.render();
  panel.set({"render.view.yaw_deg=20"});
  renderer.idle();
  panel.set({"render.shading.ambient=0.3"});
  renderer.idle();
  std::vector<std::pair<int, bool>> pictures;
  for (const auto& each : shown) {
    pictures.emplace_back(each->picture.depth_m.width, each->is_coarse);
  }
  EXPECT_EQ(pictures,
            (std::vector<std::pair<int, bool>>{{64, false}, {32, true}, {64, false}, {64, false}}));
  const auto alone = render::render_volume(*context, volume, panel.state()->scene.render());
  EXPECT_EQ(shown.back()->picture.surface.pixels, alone.surface.pixels);
  EXPECT_TRUE(render::testing::same_bits(shown.back()->picture.depth_m, alone.depth_m));
}

TEST_F(Live, NobodyPublishesOnceRunHasThrown) {
  Stream stream("sim", kSmall);
  Viewer viewer;
  viewer.watch = [&] {
    if (viewer.of(Channel::picture) > 0) throw std::logic_error("the viewer's fault");
  };
  EXPECT_THROW(stream.pipeline.run(viewer), std::logic_error);
  for (auto& count : viewer.published) count = 0;
  stream.pipeline.refresh();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  for (const auto& count : viewer.published) EXPECT_EQ(count, 0);
}

TEST_F(Live, PastVolumesAreShownAlsoAfterReconnectingFailed) {
  const fs::path recording = at("recording.wbst");
  fs::copy_file(recorded(2) / "recording.wbst", recording);
  Stream stream(
      "file=" + recording.string(),
      words_of("phantom.name=sphere phantom.voxel_mm=2 render.ray_casting.image_size=64"));
  Viewer viewer;
  int step = 0;
  viewer.watch = [&] {
    const auto status = stream.panel.status();
    const bool has_ended = status["stage"] == "ended";
    if (step == 0 && has_ended) {
      fs::remove(recording);
      stream.panel.play(true);
      step = 1;
    } else if (step == 1 && has_ended && status["why"] != "") {
      stream.pipeline.show_past(0, "picture");
      step = 2;
    } else if (step >= 2 && (viewer.of(Channel::past) > 0 || ++step > 40)) {
      throw std::logic_error("enough");
    }
  };
  EXPECT_THROW(stream.pipeline.run(viewer), std::logic_error);
  EXPECT_GT(viewer.of(Channel::past), 0);
}

}  // namespace
}  // namespace wobblebench::bench
