// Labels of a picture's truth: what hides its points from the probe, and its landmarks.
#include "bench/evaluation/truth/labels.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>
#include <vector>

#include "bench/scene/scene.h"
#include "phantoms/float_grid.h"

namespace wobblebench::bench {
namespace {

using phantoms::Part;

struct Seen {
  ResolvedScene scene;
  Truth truth;
  Labels labels;

  const SeenLandmark& landmark(const std::string& name) const {
    return *std::ranges::find(labels.landmarks, name, &SeenLandmark::name);
  }
  Part part(int column, int row) const { return static_cast<Part>(truth.part.at(column, row)); }
};

Seen look(std::vector<std::string> settings) {
  settings.emplace_back("render.ray_casting.image_size=96");
  settings.emplace_back("phantom.voxel_mm=0.7");
  const Scene given = load_scene({}, settings);
  const ResolvedScene scene = resolve_scene(given, phantoms::make_phantom(given.phantom));
  const StickReach reach(scene);
  const Truth truth = true_surface(scene, scene.view(), reach);
  return {scene, truth, label_truth(scene, truth, reach)};
}

const Seen& with_hand() {
  static const Seen seen = look({"phantom.hand=before"});
  return seen;
}

const Seen& with_cord() {
  static const Seen seen = look({"phantom.cord=before", "phantom.cord_gap_mm=6"});
  return seen;
}

const Seen& bare_face() {
  static const Seen seen =
      look({"phantom.head_yaw_deg=0", "phantom.head_pitch_deg=0", "phantom.head_roll_deg=0"});
  return seen;
}

/// The material at a point, by OpenVDB's own interpolation of all level sets.
class Tissue {
 public:
  explicit Tissue(const phantoms::PlacedPhantom& subject) : subject_(subject) {}

  bool is_fluid(const glm::dvec3& probe_m) const {
    const openvdb::Vec3d at = phantoms::to_vdb(subject_.placement.to_phantom(probe_m));
    const auto& phantom = subject_.phantom;
    auto material = phantom.background();
    for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
      const auto& grid = *phantom.grids().signed_distance[i];
      const auto accessor = grid.getConstAccessor();
      const openvdb::tools::GridSampler<phantoms::FloatGrid::ConstAccessor,
                                        openvdb::tools::BoxSampler>
          sampler(accessor, grid.transform());
      if (sampler.wsSample(at) < 0) material = phantom.surfaces()[i].inside;
    }
    return phantom.materials().at(static_cast<std::size_t>(material)).name == "amniotic_fluid";
  }

 private:
  const phantoms::PlacedPhantom& subject_;
};

/// How far before a point the sound goes from fluid into tissue for the first time: in small steps
/// along the range at the point's two angles. Not until there: less than nothing.
double first_entry_before_m(const Tissue& tissue,
                            const hw::ProbeGeometry& geometry,
                            const glm::dvec3& point_m) {
  constexpr double kStep_m = 0.05e-3;
  hw::PolarPoint polar = geometry.to_polar(point_m);
  const double end_m = polar.range_m;
  bool was_fluid = false;
  for (polar.range_m = 0; polar.range_m < end_m; polar.range_m += kStep_m) {
    const bool is_fluid = tissue.is_fluid(geometry.to_cartesian(polar));
    if (was_fluid && !is_fluid) return end_m - polar.range_m;
    was_fluid = is_fluid;
  }
  return -1;
}

glm::dvec3 point_of(const Seen& seen, int column, int row) {
  const auto depth_m = static_cast<double>(seen.truth.crossing_m.at(column, row));
  return seen.scene.view().camera.ray(column, row).at(depth_m);
}

void expect_march_agrees(const Seen& seen) {
  const Tissue tissue(seen.scene.subject().value());
  const hw::ProbeGeometry geometry = seen.scene.plan().geometry();
  int compared = 0, hidden = 0, other = 0;
  for (int row = 1; row < 96; row += 3) {
    for (int column = 1; column < 96; column += 3) {
      if (seen.truth.kind.at(column, row) == TruthKind::none) continue;
      const glm::dvec3 point_m = point_of(seen, column, row);
      // A rim of the own surface within a millimetre does not count, another surface does.
      const double entry_m = first_entry_before_m(tissue, geometry, point_m);
      const bool near = entry_m > 0.15e-3, far = entry_m > 1.3e-3;
      if (near != far) continue;
      ++compared;
      hidden += far;
      other += far != (seen.labels.before.at(column, row) != 0);
    }
  }
  EXPECT_GT(compared, 400);
  EXPECT_GT(hidden, 15);
  EXPECT_LE(other, compared / 200) << "of " << compared << ", hidden " << hidden;
}

TEST(LabelTruth, VisibilityAgreesWithAMarchThroughTheTissue) {
  expect_march_agrees(with_hand());
  expect_march_agrees(with_cord());
  expect_march_agrees(look({"phantom.placenta_mm=6", "phantom.identity=6"}));
}

void expect_hides(const Seen& seen, Part occluder) {
  int behind = 0, front = 0;
  for (std::size_t i = 0; i < seen.truth.part.pixels.size(); ++i) {
    const auto before = static_cast<Part>(seen.labels.before.pixels[i]);
    const auto part = static_cast<Part>(seen.truth.part.pixels[i]);
    behind += before == occluder && part != occluder;
    front += part == occluder && before == Part::none;
  }
  EXPECT_GT(behind, 10);
  EXPECT_GT(front, 200);
}

TEST(LabelTruth, VisibilityOfAPointBehindHandOrCordIsNone) {
  expect_hides(with_hand(), Part::hand);
  expect_hides(with_cord(), Part::cord);
  const SeenLandmark& chin = with_hand().landmark("pogonion");
  EXPECT_FALSE(chin.is_visible());
  EXPECT_FALSE(chin.in_picture);
  EXPECT_EQ(static_cast<Part>(chin.before), Part::hand);
}

TEST(LabelTruth, VisibilityIsNotTakenByWhatTheMotherHasBeforeTheFluid) {
  const Seen seen = look({"phantom.placenta_mm=6", "phantom.maternal_layer_mm=10"});
  int nose = 0, hidden = 0;
  for (std::size_t i = 0; i < seen.truth.part.pixels.size(); ++i) {
    if (static_cast<Part>(seen.truth.part.pixels[i]) != Part::nose) continue;
    ++nose;
    hidden += seen.labels.before.pixels[i] != 0;
  }
  EXPECT_GT(nose, 30);
  EXPECT_LT(hidden, nose / 4);
  EXPECT_TRUE(seen.landmark("pronasale").is_visible());
}

TEST(LabelTruth, PixelLabelsNameThePartsOfTheFace) {
  const Seen& seen = bare_face();
  const SeenLandmark& tip = seen.landmark("pronasale");
  ASSERT_TRUE(tip.in_picture);
  EXPECT_EQ(seen.part(static_cast<int>(std::lround(tip.at.column)),
                      static_cast<int>(std::lround(tip.at.row))),
            Part::nose);
  std::map<Part, int> pixels;
  for (const std::uint8_t label : seen.truth.part.pixels) ++pixels[static_cast<Part>(label)];
  for (const Part part : {Part::forehead,
                          Part::nose,
                          Part::eyelids,
                          Part::cheek,
                          Part::chin,
                          Part::upper_lip,
                          Part::lower_lip,
                          Part::ear,
                          Part::cord,
                          Part::hand}) {
    EXPECT_GT(pixels[part], 5) << static_cast<int>(part);
  }
  EXPECT_EQ(pixels[Part::cleft], 0);
  EXPECT_EQ(pixels[Part::placenta], 0);
}

TEST(LabelTruth, PixelLabelsAreThoseOfTheVoxelsJustBehindThem) {
  const Seen& seen = with_hand();
  const phantoms::LabelFinder finder(seen.scene.subject()->phantom);
  int compared = 0, other = 0;
  for (int row = 0; row < 96; ++row) {
    for (int column = 0; column < 96; ++column) {
      if (seen.truth.kind.at(column, row) == TruthKind::none) continue;
      const glm::dvec3 inwards = -glm::dvec3(seen.truth.normal.at(column, row));
      const glm::dvec3 at_m = point_of(seen, column, row) + 0.1e-3 * inwards;
      ++compared;
      other += finder.at(seen.scene.subject()->to_rest(at_m, 0)) != seen.truth.part.at(column, row);
    }
  }
  EXPECT_GT(compared, 4000);
  EXPECT_LE(other, compared / 50) << "only at borders of parts";
}

struct Depths {
  double least_m = 1, most_m = 0;
};
/// Of a pixel and its neighbours.
Depths depths_about(const Truth& truth, int column, int row) {
  Depths found;
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = column - 1; c <= column + 1; ++c) {
      const auto depth_m = static_cast<double>(truth.crossing_m.at(c, r));
      if (std::isnan(depth_m)) continue;
      found = {std::min(found.least_m, depth_m), std::max(found.most_m, depth_m)};
    }
  }
  return found;
}

TEST(LabelTruth, LandmarksThatThePictureShowsLieAtTheDepthOfTheirPixels) {
  for (const Seen* seen : {&bare_face(), &with_hand()}) {
    int shown = 0;
    for (const SeenLandmark& landmark : seen->labels.landmarks) {
      if (!landmark.in_picture) continue;
      ++shown;
      const int column = static_cast<int>(std::lround(landmark.at.column));
      const int row = static_cast<int>(std::lround(landmark.at.row));
      const auto range = depths_about(seen->truth, column, row);
      EXPECT_GT(landmark.at.depth_m, range.least_m - 0.4e-3) << landmark.name;
      EXPECT_LT(landmark.at.depth_m, range.most_m + 0.4e-3) << landmark.name;
    }
    EXPECT_GE(shown, seen == &bare_face() ? 12 : 5);
  }
}

// The ears' ends lie at the rim of the picture's head.
TEST(LabelTruth, PixelsOfLandmarksThatThePictureShowsHaveTheSkin) {
  int ears = 0;
  for (const int identity : {0, 2, 3, 6, 9}) {
    const Seen seen = look({"phantom.identity=" + std::to_string(identity)});
    for (const SeenLandmark& landmark : seen.labels.landmarks) {
      if (!landmark.in_picture) continue;
      ears += landmark.name.find("aurale") != std::string::npos;
      const auto shown_m = static_cast<double>(
          seen.truth.crossing_m.at(static_cast<int>(std::lround(landmark.at.column)),
                                   static_cast<int>(std::lround(landmark.at.row))));
      EXPECT_LT(std::abs(shown_m - landmark.at.depth_m), 3e-3) << landmark.name << ' ' << identity;
      EXPECT_FALSE(std::isnan(shown_m)) << landmark.name << ' ' << identity;
    }
  }
  EXPECT_GE(ears, 3);
}

TEST(LabelTruth, LandmarksAreVisibleWhereTheMarchMeetsNothing) {
  for (const Seen* seen : {&bare_face(), &with_hand()}) {
    const Tissue tissue(seen->scene.subject().value());
    const hw::ProbeGeometry geometry = seen->scene.plan().geometry();
    int visible = 0;
    for (const SeenLandmark& landmark : seen->labels.landmarks) {
      const double entry_m = first_entry_before_m(tissue, geometry, landmark.position_m);
      const bool near = entry_m > 0.15e-3, far = entry_m > 1.3e-3;
      if (near != far) continue;
      EXPECT_EQ(landmark.before != 0, far) << landmark.name;
      visible += landmark.is_visible();
    }
    EXPECT_GE(visible, 4);
  }
}

TEST(LabelTruth, LandmarksOfAMovingHeadAreWhereItsSticksFindThem) {
  const Seen seen = look({"motion.velocity_mm_s=[0, 0, 20]"});
  const auto& subject = seen.scene.subject().value();
  const hw::AcquisitionPlan& plan = seen.scene.plan();
  for (const SeenLandmark& landmark : seen.labels.landmarks) {
    const auto stick = plan.nearest_stick(plan.geometry().to_polar(landmark.position_m), 0);
    const double time_s =
        1e-9 *
        static_cast<double>(plan.stick_time(plan.sequence(stick)).time_since_epoch().count());
    const auto& rest =
        *std::ranges::find(subject.phantom.landmarks(), landmark.name, &phantoms::Landmark::name);
    const glm::dvec3 wanted =
        subject.placement.to_probe(rest.position_m) + glm::dvec3(0, 0, 20e-3 * time_s);
    EXPECT_LT(glm::distance(landmark.position_m, wanted), 1e-6) << landmark.name;
  }
  EXPECT_TRUE(seen.landmark("pronasale").in_picture);
}

TEST(LabelTruth, PixelLabelsOfUnnamedPhantomsAreThoseOfTheirSurfaces) {
  const Scene given = load_scene(
      {}, {"phantom.name=sphere", "phantom.voxel_mm=1", "render.ray_casting.image_size=48"});
  const ResolvedScene scene = resolve_scene(given, phantoms::make_phantom(given.phantom));
  const StickReach reach(scene);
  const Truth truth = true_surface(scene, scene.view(), reach);
  const Labels labels = label_truth(scene, truth, reach);
  EXPECT_TRUE(truth.parts.empty());
  EXPECT_EQ(truth.part.at(24, 24), phantoms::kFirstUnnamed);
  ASSERT_EQ(labels.names.size(), 1U);
  EXPECT_EQ(labels.names[0].name, scene.subject()->phantom.surfaces()[0].name);
  EXPECT_TRUE(labels.landmarks.empty());
}

}  // namespace
}  // namespace wobblebench::bench
