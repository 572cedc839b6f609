// Anomalies and expressions: their severity, measured on the surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/units.h"
#include "phantoms/fetal/fetal_child.h"
#include "phantoms/options.h"
#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

double value(const FetalChild& child, const std::string& name) {
  for (const PhantomMeasure& measure : measures_of(child)) {
    if (measure.name == name) return measure.value;
  }
  ADD_FAILURE() << "no measure " << name;
  return 0;
}

FetalChild with(void (*change)(PhantomOptions&), std::uint64_t identity = 0) {
  PhantomOptions options;
  options.identity = identity;
  change(options);
  return make_child(options);
}

const FetalChild& usual() {
  static const FetalChild child = make_child({});
  return child;
}

TEST(Anomaly, MovesItsMeasureByItsSeverity) {
  const FetalChild retruded = with([](PhantomOptions& o) { o.chin_back_rad = 17 * kDegree; });
  EXPECT_NEAR(value(retruded, "inferior_facial_angle_deg"), 65.5 - 17, 0.3);
  EXPECT_LT(value(retruded, "inferior_facial_angle_deg"), 49.2) << "Rotten's cut-off";
  const FetalChild small = with([](PhantomOptions& o) { o.jaw_shorter_m = 5e-3; });
  EXPECT_NEAR(value(small, "mandible_mm"), value(usual(), "mandible_mm") - 5, 0.3);
  const FetalChild wide = with([](PhantomOptions& o) { o.eyes_apart_m = 3e-3; });
  EXPECT_NEAR(value(wide, "interocular_mm"), value(usual(), "interocular_mm") + 3, 0.3);
  EXPECT_NEAR(value(wide, "zygomatic_width_mm"), value(usual(), "zygomatic_width_mm"), 0.3)
      << "the face is no wider";
  const FetalChild low = with([](PhantomOptions& o) { o.ears_lower_rad = 9 * kDegree; });
  EXPECT_NEAR(value(low, "ear_eye_angle_deg"), 1.26 + 9, 0.3);
  const FetalChild bossed = with([](PhantomOptions& o) { o.bossing_m = 4e-3; });
  EXPECT_GT(value(bossed, "profile_line_distance_mm"),
            value(usual(), "profile_line_distance_mm") + 2.5);
}

TEST(Anomaly, NasalBoneIsShortOrAbsent) {
  const FetalChild brief = with([](PhantomOptions& o) { o.nasal_bone_shorter_m = 3e-3; });
  EXPECT_NEAR(value(brief, "nasal_bone_mm"), value(usual(), "nasal_bone_mm") - 3, 0.3);
  EXPECT_NEAR(value(brief, "prenasal_mm"), value(usual(), "prenasal_mm"), 0.3) << "the skin stays";
  const FetalChild absent = with([](PhantomOptions& o) { o.nasal_bone_shorter_m = 20e-3; });
  EXPECT_TRUE(absent.solved.head.nasal_bone.empty());
  EXPECT_EQ(value(absent, "nasal_bone_mm"), 0);
  EXPECT_NEAR(value(absent, "prenasal_mm"), value(usual(), "prenasal_mm"), 0.3);
}

// By steps of 0.05 mm along the lip's edge: fluid between tissue.
TEST(Anomaly, CleftIsAGapOfItsWidthOnItsSide) {
  for (const double width_mm : {2.0, 4.0}) {
    PhantomOptions options;
    options.cleft_width_m = width_mm * kMillimetre;
    for (const Side side : {Side::left, Side::right}) {
      options.cleft_side = side;
      const FetalChild child = make_child(options);
      const HeadShape& shape = child.solved.shape;
      const double z = -1.0e-3, y = shape.unit_m * (shape.upper_lip + 0.6);
      // The child's left is at +x.
      const double middle = (side == Side::left ? 1 : -1) * 2.6 * shape.unit_m;
      double fluid = 0;
      for (const double along : {-1.0, 1.0}) {
        for (double off = 0; off < 8e-3; off += 0.05e-3) {
          if (child.solved.head.skin.distance({middle + along * off, y, z}) < 0) break;
          fluid += 0.05e-3;
        }
      }
      EXPECT_NEAR(fluid / kMillimetre, width_mm, 0.6) << width_mm;
      EXPECT_NEAR(fluid / kMillimetre, value(child, "cleft_width_mm"), 0.6) << "at one depth";
      EXPECT_LT(child.solved.head.skin.distance({-middle, y, z}), 0) << "the other side is whole";
    }
  }
}

/// Narrowest gap of the upper lip's edge, to 3 units behind the front of its farther side: by small
/// steps, and only by what is inside the skin.
double lip_gap_m(const FetalChild& child) {
  constexpr double kStep_m = 0.02e-3, kFarthest_m = 7e-3;
  const HeadShape& shape = child.solved.shape;
  const double x = shape.unit_m * 2.6, y = shape.unit_m * (shape.upper_lip + 0.6);
  double narrowest_m = 1, end_m = 10e-3;
  for (double z = -10e-3; z < end_m; z += 0.2e-3) {
    double gap_m = 0;
    bool ends = true;
    for (const double along : {-1.0, 1.0}) {
      double off_m = 0;
      while (off_m < kFarthest_m &&
             child.solved.head.skin.distance({x + along * off_m, y, z}) > 0) {
        off_m += kStep_m;
      }
      gap_m += off_m;
      ends &= off_m < kFarthest_m;
    }
    if (!ends) continue;
    narrowest_m = std::min(narrowest_m, gap_m);
    end_m = std::min(end_m, z + 3 * shape.unit_m);
  }
  return narrowest_m;
}

TEST(Anomaly, CleftMeasuresWhatTheFinishedLipHas) {
  struct Case {
    double weeks;
    std::uint64_t identity;
    double width_mm, alveolus_mm;
  };
  for (const Case& of : {Case{21, 0, 4, 4},
                         Case{30, 7, 4, 4},
                         Case{30, 30, 4, 4},
                         Case{24, 3, 6, 5},
                         Case{21, 1, 1, 0},
                         Case{30, 14, 2, 0}}) {
    PhantomOptions options{.gestational_age_weeks = of.weeks, .identity = of.identity};
    options.cleft_width_m = of.width_mm * kMillimetre;
    options.cleft_alveolus_m = of.alveolus_mm * kMillimetre;
    const FetalChild child = make_child(options);
    const double measured_mm = value(child, "cleft_width_mm");
    EXPECT_NEAR(measured_mm, lip_gap_m(child) / kMillimetre, 0.25) << "identity " << of.identity;
    EXPECT_NEAR(measured_mm, of.width_mm, 0.6) << "identity " << of.identity;
  }
}

TEST(Anomaly, CleftAlveolusOpensTheBone) {
  PhantomOptions options;
  options.cleft_width_m = 4e-3;
  const FetalChild lip = make_child(options);
  options.cleft_alveolus_m = 4e-3;
  const FetalChild jaw = make_child(options);
  const HeadShape& shape = jaw.solved.shape;
  const glm::dvec3 behind = shape.unit_m * glm::dvec3(2.6, shape.upper_lip, 7);
  EXPECT_LT(lip.solved.head.skin.distance(behind), 0);
  EXPECT_GT(jaw.solved.head.skin.distance(behind), 0) << "fluid in the gap";
  EXPECT_GT(jaw.solved.head.skull.distance(behind), lip.solved.head.skull.distance(behind));
}

TEST(Expression, ChangesTheSkinAndNoBone) {
  const FetalChild smile = with([](PhantomOptions& o) { o.smile_m = 2e-3; });
  const FetalChild lids = with([](PhantomOptions& o) { o.lids_open_m = 3e-3; });
  EXPECT_NEAR(value(smile, "facial_height_mm"), value(usual(), "facial_height_mm"), 1e-6);
  const auto differs = [&](const FetalChild& child, const glm::dvec3& at_mm) {
    const glm::dvec3 at = kMillimetre * at_mm;
    return std::abs(child.solved.head.skin.distance(at) - usual().solved.head.skin.distance(at));
  };
  const double mouth = usual().solved.shape.mouth();
  EXPECT_GT(differs(smile, {8.2, mouth - 1.5, 2.5}), 0.3e-3);
  EXPECT_LT(differs(smile, {0, -15, -2}), 1e-9);
  EXPECT_GT(differs(lids, {12, 2.5, 2.3}), 0.2e-3);
  PhantomOptions options;
  options.tongue_m = 3e-3;
  EXPECT_THROW(validate(options), InvalidPhantom) << "behind closed lips";
  options.mouth_open_m = 6e-3;
  validate(options);
  const FetalChild tongue = make_child(options);
  const HeadShape& shape = tongue.solved.shape;
  const glm::dvec3 before =
      shape.unit_m * glm::dvec3(1.4, shape.mouth() + 0.68 * shape.open + 0.5, -3.5);
  EXPECT_LT(tongue.solved.head.skin.distance(before), 0) << "the tongue before the lips";
}

TEST(Identity, ImpossibleFacesAreRefusedInOneLine) {
  PhantomOptions options;
  options.chin_back_rad = 30 * kDegree;
  options.jaw_shorter_m = 10e-3;
  options.eyes_apart_m = -5e-3;
  options.nasal_bone_shorter_m = 3e-3;
  const std::string line = refusal_of<InvalidPhantom>([&] { make_child(options); });
  EXPECT_TRUE(line.starts_with("identity = 0: no such face: ")) << line;
  EXPECT_FALSE(holds(line, "\n"));
}

}  // namespace
}  // namespace wobblebench::phantoms
