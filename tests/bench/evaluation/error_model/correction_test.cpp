// A correction as a file, what it refuses, and what it does to z.
#include "bench/evaluation/error_model/correction.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "base/user_error.h"
#include "bench/scene/resolved_scene.h"
#include "phantoms/phantom.h"
#include "render/camera.h"
#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

Scene small_scene(std::vector<std::string> settings = {}) {
  settings.insert(settings.begin(), {"phantom.name=sphere", "render.ray_casting.image_size=32"});
  return load_scene({}, settings);
}

Correction correction_of(const Scene& scene, double constant_mm) {
  Correction correction{
      {}, correction_conditions(scene), render::step_m(scene.render) / kMillimetre};
  correction.model.bias[kConstantTerm] = {constant_mm, constant_mm, constant_mm, true};
  return correction;
}

class CorrectionFile : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    const auto path = folder_.path() / "correction.json";
    std::ofstream(path) << text;
    return path.string();
  }
  /// What read_correction() says of a scene with these settings and the file.
  std::string refusal(const std::string& file, std::vector<std::string> settings = {}) {
    settings.push_back("render.correction=" + file);
    return refusal_of<UserError>([&] { read_correction(small_scene(settings)); });
  }
  ScratchFolder folder_;
};

TEST_F(CorrectionFile, IsReadAsItWasWritten) {
  const Scene scene = small_scene();
  const std::string file = write(correction_text(correction_of(scene, -1.25)));
  const auto read = read_correction(small_scene({"render.correction=" + file}));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->model.bias[kConstantTerm].value, -1.25);
  EXPECT_EQ(read->model.bias[kDepthTerm].value, 0);
  EXPECT_FALSE(read_correction(scene)) << "none is named";
}

TEST_F(CorrectionFile, OfOtherConditionsIsRefusedInOneLine) {
  const std::string file = write(correction_text(correction_of(small_scene(), 1)));
  for (const std::string& other :
       words_of("probe.preset=c5-2v probe.wobble_radius_mm=20 acquisition.frames_per_volume=20 "
                "acquisition.sticks_per_frame=32 acquisition.samples_per_stick=256 "
                "render.ray_casting.buffer_length=16 render.ray_casting.detector=floor "
                "render.ray_casting.iso_level=0.6 render.ray_casting.incidence_correction_mm=1 "
                "render.reconstruction.sticks=plain render.ray_casting.steps=512 "
                "render.ray_casting.threshold=0.2 render.shading.depth_filter_size=5 "
                "simulation.dynamic_range_db=70")) {
    const std::string said = refusal(file, {other});
    EXPECT_TRUE(holds(said, other.substr(0, other.find('=')))) << other;
    EXPECT_FALSE(holds(said, "\n"));
  }
  for (const std::string& same :
       words_of("phantom.name=plane render.view.yaw_deg=20 render.ray_casting.image_size=64 "
                "render.pipeline.mode=plain simulation.seed=9")) {
    EXPECT_EQ(refusal(file, {same}), "");
  }
}

TEST_F(CorrectionFile, ThatIsNoneIsRefusedInOneLine) {
  for (const std::string text : {"", "{}", "[1]", "{\"kind\": \"other\"}", "no json"}) {
    EXPECT_TRUE(holds(refusal(write(text)), "is not a correction")) << text;
  }
  EXPECT_TRUE(holds(refusal("nowhere.json"), "no such file"));
}

TEST_F(CorrectionFile, OfAnotherStepIsRefused) {
  const Scene scene = small_scene();
  Correction correction = correction_of(scene, 1);
  EXPECT_NO_THROW(check_correction(correction, scene));
  correction.step_mm *= 1.2;
  EXPECT_THROW(check_correction(correction, scene), UserError);
}

TEST_F(CorrectionFile, IsRefusedByRunBeforeAnyWork) {
  const std::string file = write(correction_text(correction_of(small_scene(), 1)));
  for (const std::string other : {"probe.preset=c5-2v",
                                  "render.ray_casting.buffer_length=16",
                                  "render.ray_casting.steps=512",
                                  "render.ray_casting.detector=paper"}) {
    const auto result = bench({"run",
                               "--set",
                               "phantom.name=sphere",
                               "--set",
                               other,
                               "--set",
                               "render.correction=" + file},
                              folder_);
    EXPECT_EQ(result.exit_code, 2) << other;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(holds(result.err, other.substr(0, other.find('='))));
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out"));
  }
}

/// The samples of a recording are on the recording's display scale, whatever the scene's is.
TEST_F(CorrectionFile, IsComparedWithTheDisplayScaleOfARecording) {
  const Words scan = with(kSphere, {kScan, set("render.ray_casting.image_size=32")});
  const Words scale = set("simulation.dynamic_range_db=70");
  ASSERT_EQ(bench(with(words_of("record --out rec"), {scan, scale}), folder_).exit_code, 0);
  const auto play = [&](const Words& made_for) {
    Words settings;
    for (std::size_t i = 1; i < made_for.size(); i += 2) settings.push_back(made_for[i]);
    Scene scene = load_scene({}, settings);
    scene = resolve_scene(scene, phantoms::make_phantom(scene.phantom)).options();
    const std::string file = write(correction_text(correction_of(scene, 1)));
    return bench(with(words_of("run --board file=rec/recording.wbst"),
                      {kSphere,
                       set("render.ray_casting.image_size=32"),
                       {"--set", "render.correction=" + file}}),
                 folder_);
  };
  const auto other = play(scan);
  EXPECT_EQ(other.exit_code, 2) << other.err;
  EXPECT_TRUE(
      holds(other.err, "was made for simulation.dynamic_range_db = 60.0; the scene has 70.0"));
  const auto same = play(with(scan, {scale}));
  EXPECT_EQ(same.exit_code, 0) << same.err;
}

/// A slanting surface in the middle of the picture.
render::CastDepth slanting(const Scene& scene) {
  const int size = scene.render.ray_casting.image_size;
  Image<float> depth_m(size, size, kNoSurface);
  for (int row = 4; row < size - 4; ++row) {
    for (int column = 4; column < size - 4; ++column) {
      depth_m.at(column, row) = 0.05f + 1e-4f * static_cast<float>(column);
    }
  }
  return {depth_m, depth_m, depth_m};
}

Image<float> corrected(const Scene& scene, double constant_mm) {
  const TermMeter meter(scene.plan(), scene.simulation, scene.render);
  const hw::PolarVolume volume(scene.plan());
  return corrected_depth(correction_of(scene, constant_mm).model, meter, slanting(scene), volume);
}

TEST(CorrectedDepth, WithoutTermsHasTheSameBits) {
  const Scene scene = small_scene();
  const auto same_m = corrected(scene, 0), depth_m = slanting(scene).depth_m;
  EXPECT_EQ(std::memcmp(
                same_m.pixels.data(), depth_m.pixels.data(), same_m.pixels.size() * sizeof(float)),
            0);
}

TEST(CorrectedDepth, SubtractsTheBiasWhereASurfaceIs) {
  const Scene scene = small_scene();
  const auto corrected_m = corrected(scene, -1), depth_m = slanting(scene).depth_m;
  for (const int column : {6, 16, 25}) {
    EXPECT_NEAR(corrected_m.at(column, 16) - depth_m.at(column, 16), 1e-3, 1e-8);
  }
  EXPECT_TRUE(std::isnan(corrected_m.at(0, 0)));
}

TEST(TermMeter, MeasuresIncidenceAndContrastOfAKnownSurface) {
  const Scene scene = small_scene();
  hw::PolarVolume volume(scene.plan());
  const auto depth = slanting(scene);
  const auto view = render::make_camera(scene.render);
  const int middle = scene.render.ray_casting.image_size / 2;
  // Samples are 0.3 before and 0.7 behind the surface's range in the middle.
  const auto point = scene.plan().geometry().to_polar(
      view.ray(middle, middle).at(static_cast<double>(depth.depth_m.at(middle, middle))));
  const auto& scan = scene.acquisition;
  for (std::uint32_t frame = 0; frame < static_cast<std::uint32_t>(scan.frames_per_volume);
       ++frame) {
    for (std::uint32_t line = 0; line < static_cast<std::uint32_t>(scan.sticks_per_frame); ++line) {
      hw::Stick stick;
      stick.index = {0, frame, line};
      for (int k = 0; k < scan.samples_per_stick; ++k) {
        stick.samples.push_back(scene.plan().sample_range_m(k) < point.range_m ? 0.3f : 0.7f);
      }
      volume.place(stick);
    }
  }
  const TermMeter meter(scene.plan(), scene.simulation, scene.render);
  const auto terms = meter.measure(depth.filtered_m, volume).at(middle, middle);
  EXPECT_NEAR(terms.x[kContrastTerm], 0.4, 0.02);
  // z grows by 0.1 mm a pixel along x; the stick in the middle is almost the ray.
  const double slope = std::atan(1e-4 / view.pixel_m());
  EXPECT_NEAR(terms.incidence_rad, std::abs(slope + point.theta_rad), 0.02);
}

}  // namespace
}  // namespace wobblebench::bench
