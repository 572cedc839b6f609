// Identities: what is drawn, and calipers of this file's own on the surfaces that come of it.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "base/units.h"
#include "phantoms/fetal/fetal_child.h"
#include "phantoms/options.h"

namespace wobblebench::phantoms {
namespace {

TEST(Identity, ZeroIsTheMeanChildAndSymmetric) {
  const FaceIdentity child = draw_identity(0, 27);
  EXPECT_EQ(child.measures.values, mean_face(27).values);
  for (const glm::dvec3& shift : child.asymmetry) EXPECT_EQ(glm::length(shift), 0);
}

TEST(Identity, OneSeedIsOneChildAtEveryAge) {
  EXPECT_EQ(draw_identity(5, 22).measures.values, draw_identity(5, 22).measures.values);
  EXPECT_NE(draw_identity(5, 22).measures.values, draw_identity(6, 22).measures.values);
  // Angles and traits have no correlation that changes with age.
  const FaceIdentity young = draw_identity(5, 22), older = draw_identity(5, 33);
  EXPECT_EQ(young.measures[FaceMeasure::nasomental_angle],
            older.measures[FaceMeasure::nasomental_angle]);
  EXPECT_EQ(young.traits.mouth_width, older.traits.mouth_width);
}

// Pearson correlation.
double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sa += a[i], sb += b[i], saa += a[i] * a[i], sbb += b[i] * b[i], sab += a[i] * b[i];
  }
  return (sab / n - sa / n * sb / n) /
         std::sqrt((saa / n - sa * sa / n / n) * (sbb / n - sb * sb / n / n));
}

// Published standard deviations, mm, without the published measuring error where there is one; the
// correlation at 20 weeks is that of Roelfsema's index, 0.27, freed of the dilution by errors.
TEST(Identity, DrawsHaveThePublishedSpreadAndCorrelation) {
  constexpr int kChildren = 4000;
  std::vector<double> around, eyes, ear, height;
  for (int seed = 1; seed <= kChildren; ++seed) {
    const FaceMeasures drawn = draw_identity(static_cast<std::uint64_t>(seed), 20).measures;
    around.push_back(drawn[FaceMeasure::head_circumference]);
    eyes.push_back(drawn[FaceMeasure::interocular]);
    ear.push_back(drawn[FaceMeasure::ear_length]);
    height.push_back(drawn[FaceMeasure::facial_height]);
  }
  const auto spread = [](const std::vector<double>& values) {
    double sum = 0, squares = 0;
    for (const double v : values) sum += v, squares += v * v;
    const auto n = static_cast<double>(values.size());
    return std::sqrt(squares / n - sum * sum / n / n);
  };
  EXPECT_NEAR(spread(around), 7.44, 0.03 * 7.44);
  EXPECT_NEAR(spread(eyes), 1.3, 0.03 * 1.3);
  EXPECT_NEAR(spread(height), std::sqrt(2.4 * 2.4 - 1.1 * 1.1), 0.03 * 2.13);
  EXPECT_NEAR(correlation(around, eyes), correlation(around, ear), 0.06);
  EXPECT_GT(correlation(eyes, ear), 0.266 - 0.03);
  EXPECT_LT(correlation(eyes, ear), 0.42);
}

// First crossing of the surface along a ray, by steps of 0.1 mm and bisection.
double crossing(const CsgBody& body, const glm::dvec3& from, const glm::dvec3& along) {
  double at = 0;
  while (body.distance(from + at * along) > 0) {
    at += 0.1 * kMillimetre;
    if (at > 0.2) {
      ADD_FAILURE() << "no surface";
      return at;
    }
  }
  double low = at - 0.1 * kMillimetre, high = at;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (body.distance(from + middle * along) > 0 ? low : high) = middle;
  }
  return high;
}

class IdentityFace : public testing::TestWithParam<std::pair<int, double>> {};

// The labels are the measures of the surface: by other calipers than the generator's, and on the
// distances that the level sets are made of.
TEST_P(IdentityFace, LabelsAreWhatCalipersMeasure) {
  const auto [seed, weeks] = GetParam();
  PhantomOptions options;
  options.identity = static_cast<std::uint64_t>(seed);
  options.gestational_age_weeks = weeks;
  const FetalChild child = make_child(options);
  const FetalHead& head = child.solved.head;
  const FaceMeasures& label = child.solved.measured.measures;
  for (std::size_t i = 0; i < kFaceMeasures; ++i) {
    EXPECT_NEAR(label.values[i], child.targets.values[i], kMostResidual)
        << face_measure_laws()[i].name;
  }
  const glm::dvec3 center = head.landmarks.skull_center_m;
  double around = 0;
  glm::dvec3 last{0};
  constexpr int kSteps = 500;
  for (int i = 0; i <= kSteps; ++i) {
    const double a = 2 * kPi * i / kSteps;
    const glm::dvec3 out{std::cos(a), 0, std::sin(a)};
    const glm::dvec3 from = center + 0.1 * out;
    const glm::dvec3 here = from - crossing(head.skull, from, -out) * out;
    if (i > 0) around += glm::distance(here, last);
    last = here;
  }
  EXPECT_NEAR(around / kMillimetre, label[FaceMeasure::head_circumference], 0.3);
  // Profile of the skin: deepest point under the nose, tips of the lips, lowest point of the chin.
  const auto front = [&](double y) {
    const glm::dvec3 from{0, y, -30 * kMillimetre};
    return from + crossing(head.skin, from, {0, 0, 1}) * glm::dvec3(0, 0, 1);
  };
  const auto extreme = [&](double from, double to, double sign) {
    glm::dvec3 best = front(from);
    for (double y = from; y < to; y += 0.02 * kMillimetre) {
      const glm::dvec3 here = front(y);
      if (sign * (here.z - best.z) > 0) best = here;
    }
    return best;
  };
  const FetalLandmarks& marks = head.landmarks;
  const glm::dvec3 base = extreme(marks.nose_tip_m.y, marks.upper_lip_m.y, +1);
  const glm::dvec3 upper = extreme(base.y, marks.mouth_m.y, -1);
  EXPECT_NEAR(glm::distance(base, upper) / kMillimetre, label[FaceMeasure::philtrum], 0.15);
  // Widest bone of the cheeks.
  double width = 0;
  for (double y = 4.5; y <= 8; y += 0.05) {
    const double unit = child.solved.shape.unit_m;
    const glm::dvec3 right{0.06, y * unit, 17.5 * unit}, left{-0.06, y * unit, 17.5 * unit};
    const double here =
        0.12 - crossing(head.skull, right, {-1, 0, 0}) - crossing(head.skull, left, {1, 0, 0});
    width = std::max(width, here);
  }
  EXPECT_NEAR(width / kMillimetre, label[FaceMeasure::zygomatic_width], 0.15);
}

INSTANTIATE_TEST_SUITE_P(Children,
                         IdentityFace,
                         testing::Values(std::pair(0, 21.0),
                                         std::pair(1, 21.0),
                                         std::pair(2, 20.0),
                                         std::pair(3, 26.3),
                                         std::pair(4, 34.0)));

TEST(Identity, AsymmetryMirroredGivesTheMirroredFace) {
  HeadShape shape;
  for (std::size_t part = 0; part < kPairedParts; ++part) {
    shape.asymmetry[part] = 1e-3 * glm::dvec3(0.5, -0.3, 0.4);
  }
  shape.asymmetry[static_cast<std::size_t>(PairedPart::nose_tip)] = {4e-4, 0, 0};
  HeadShape other = shape;
  for (glm::dvec3& shift : other.asymmetry) shift = -shift;
  const FetalHead a = build_head(shape), b = build_head(other);
  const FetalHead even = build_head(HeadShape{});
  double most = 0, differ = 0, uneven = 0;
  for (double x = -25; x <= 25; x += 2.5) {
    for (double y = -30; y <= 30; y += 2.5) {
      const glm::dvec3 from = 1e-3 * glm::dvec3(x, y, -20), flip = from * glm::dvec3(-1, 1, 1);
      if (a.skin.distance(from + glm::dvec3(0, 0, 0.03)) > 0) continue;
      const double here = crossing(a.skin, from, {0, 0, 1});
      const double there = crossing(b.skin, flip, {0, 0, 1});
      most = std::max(most, std::abs(here - there));
      differ = std::max(differ, std::abs(here - crossing(a.skin, flip, {0, 0, 1})));
      uneven = std::max(
          uneven,
          std::abs(crossing(even.skin, from, {0, 0, 1}) - crossing(even.skin, flip, {0, 0, 1})));
    }
  }
  // Fillets depend a little on the order of the two sides, near the median plane.
  EXPECT_LT(most, 0.1e-3);
  EXPECT_LT(uneven, 0.1e-3);
  EXPECT_GT(differ, 0.3e-3) << "left and right differ";
}

}  // namespace
}  // namespace wobblebench::phantoms
