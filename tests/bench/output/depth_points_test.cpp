// Points in millimetres of a depth map, from what its file says alone, against a ball that is known
// in closed form.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/bench/cli/program_under_test.h"

namespace wobblebench::bench {
namespace {

constexpr double kRadius_mm = 20;
const glm::dvec3 kCenter_mm{7, -5, 108};
const Words kBall = set(
    "phantom.name=sphere placement.position_mm=[7,-5,108] simulation.fidelity=geometry "
    "render.ray_casting.incidence_correction_mm=0 "
    "render.volume_of_interest.center_mm=[3,4,104] render.volume_of_interest.size_mm=[60,70,52]");

const Words kFineSlices = set("render.scan_conversion.slice_size=256");

struct DepthFile {
  int size = 0;
  std::vector<float> z;
  std::array<float, 16> to_camera{}, to_ndc{};
  std::string projection, units;
  float mm_per_pixel = 0;

  explicit DepthFile(const fs::path& path) {
    const auto file = OIIO::ImageInput::open(path.string());
    if (!file) return;
    const OIIO::ImageSpec& spec = file->spec();
    size = spec.width;
    z.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    file->read_image(0, 0, 0, 1, OIIO::TypeFloat, z.data());
    spec.getattribute("worldToCamera", OIIO::TypeMatrix, to_camera.data());
    spec.getattribute("worldToNDC", OIIO::TypeMatrix, to_ndc.data());
    projection = spec.get_string_attribute("projection");
    units = spec.get_string_attribute("units");
    mm_per_pixel = spec.get_float_attribute("mmPerPixel");
  }

  /// [x y z 1] M with the rows of M in the order of the file.
  static glm::dmat4 from_left(const std::array<float, 16>& rows) {
    glm::dmat4 m;
    for (std::size_t i = 0; i < 16; ++i) {
      m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = static_cast<double>(rows[i]);
    }
    return m;
  }

  /// The point that a pixel shows; nothing of the program's camera is used.
  glm::dvec3 point(int column, int row) const {
    const double depth = static_cast<double>(z.at(static_cast<std::size_t>(row * size + column)));
    const glm::dmat4 back = glm::inverse(from_left(to_ndc));
    const double x = (2.0 * column + 1) / size - 1, y = 1 - (2.0 * row + 1) / size;
    const auto unprojected = [&](double ndc_z) {
      const glm::dvec4 p = back * glm::dvec4(x, y, ndc_z, 1);
      return glm::dvec3(p) / p.w;
    };
    const glm::dvec3 start = unprojected(0);
    const glm::dvec3 direction = glm::normalize(unprojected(0.25) - start);
    const glm::dvec4 eye = glm::inverse(from_left(to_camera)) * glm::dvec4(0, 0, 0, 1);
    return (projection == "parallel" ? start : glm::dvec3(eye)) + depth * direction;
  }
};

double largest_miss_mm(const DepthFile& file, double quantile, int& points) {
  std::vector<double> misses;
  for (int row = 0; row < file.size; ++row) {
    for (int column = 0; column < file.size; ++column) {
      if (!std::isfinite(file.z[static_cast<std::size_t>(row * file.size + column)])) continue;
      misses.push_back(std::abs(glm::distance(file.point(column, row), kCenter_mm) - kRadius_mm));
    }
  }
  points = static_cast<int>(misses.size());
  if (misses.empty()) return HUGE_VAL;
  std::sort(misses.begin(), misses.end());
  return misses[static_cast<std::size_t>(quantile * static_cast<double>(misses.size() - 1))];
}

struct View {
  const char* name;
  Words settings;
};

class DepthPoints : public testing::TestWithParam<View> {};

TEST_P(DepthPoints, LieOnTheBallThatWasScanned) {
  const ScratchFolder folder;
  const auto ran =
      bench(with({"run"}, {kBall, kPicture, kFineSlices, GetParam().settings}), folder);
  ASSERT_EQ(ran.exit_code, 0) << ran.err;
  int points = 0;
  const DepthFile truth(folder.path() / "out/truth_depth.exr");
  // The true surface is that of voxels of 0.5 mm.
  EXPECT_LT(largest_miss_mm(truth, 1, points), 0.05);
  EXPECT_GT(points, 400);
  const DepthFile found(folder.path() / "out/depth.exr");
  EXPECT_LT(largest_miss_mm(found, 0.5, points), 1.5);
  EXPECT_GT(points, 400);
  EXPECT_EQ(found.units, "mm");
  EXPECT_NEAR(found.mm_per_pixel, 70.0 / 64, 1e-6) << "the longer of x and y over the picture";

  const auto report = nlohmann::json::parse(bytes_of(folder.path() / "out/report.json"));
  const auto& camera = report.at("camera");
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_NEAR(camera.at("world_to_camera").at(i / 4).at(i % 4), found.to_camera.at(i), 1e-4);
    EXPECT_NEAR(camera.at("world_to_ndc").at(i / 4).at(i % 4), found.to_ndc.at(i), 1e-4);
  }
  EXPECT_NEAR(camera.at("mm_per_pixel"), 70.0 / 64, 1e-9);
}

const View kViews[] = {
    {"at_rest", {}},
    {"turned", set("render.view.yaw_deg=25 render.view.pitch_deg=-15 render.view.roll_deg=35")},
    {"turned_in_perspective",
     set("render.view.yaw_deg=-20 render.view.pitch_deg=12 render.view.roll_deg=-50 "
         "render.view.projection=perspective render.view.eye_distance_mm=90")},
    {"flipped",
     set("render.view.yaw_deg=25 render.view.roll_deg=20 render.view.flip=true "
         "render.view.projection=perspective")}};

INSTANTIATE_TEST_SUITE_P(Views, DepthPoints, testing::ValuesIn(kViews), [](const auto& view) {
  return std::string(view.param.name);
});

/// Left of a picture at rest is -x of the probe frame, where line 0 lies; of a flipped one +x.
TEST(PictureSides, LeftIsTheSideOfTheFirstLineUnlessThePictureIsFlipped) {
  for (const bool flip : {false, true}) {
    const ScratchFolder folder;
    const std::string setting = std::string("render.view.flip=") + (flip ? "true" : "false");
    ASSERT_EQ(bench(with({"run", "--set", setting}, {kBall, kPicture}), folder).exit_code, 0);
    const DepthFile found(folder.path() / "out/depth.exr");
    int left = 0, right = 0;
    for (int i = 0; i < 64 * 64; ++i) {
      if (std::isfinite(found.z.at(static_cast<std::size_t>(i)))) ++(i % 64 < 32 ? left : right);
    }
    // The ball lies 4 mm to the side of +x from the middle of the box.
    EXPECT_EQ(left > right, flip) << left << " " << right;
  }
}

using DepthToPoints = InFolder;

TEST_F(DepthToPoints, TheExampleLaysAFoundSurfaceOntoItsMesh) {
  const std::string mesh = std::string(WOBBLEBENCH_SOURCE_DIR) + "/docs/scenes/pebble.obj";
  const Words pebble =
      set("phantom.name=mesh placement.position_mm=[6,-4,112] simulation.fidelity=geometry "
          "render.view.yaw_deg=30 render.view.projection=perspective");
  ASSERT_EQ(bench("run", {pebble, {"--set", "phantom.file=" + mesh}, kPicture}).exit_code, 0);
  const auto registered = testing_support::run_process(
      WOBBLEBENCH_DEPTH_TO_POINTS, {"out/truth_depth.exr", mesh, "6", "-4", "112"}, folder_.path());
  ASSERT_EQ(registered.exit_code, 0) << registered.err;
  std::istringstream words(registered.err);
  int points = 0;
  double median_mm = 0, p95_mm = 0;
  std::string word;
  words >> points;
  while (words >> word && word != "median") {
  }
  words >> median_mm >> word >> word >> p95_mm;
  EXPECT_GT(points, 400) << registered.err;
  EXPECT_LT(median_mm, 0.05) << registered.err;
  EXPECT_LT(p95_mm, 0.25) << registered.err << "edges are rounded by voxels of 0.5 mm";
  EXPECT_EQ(std::count(registered.out.begin(), registered.out.end(), '\n'), points);
}

}  // namespace
}  // namespace wobblebench::bench
