// Caliper measurements on the grids of the fetal_face phantom, against the published means.
#include <gtest/gtest.h>
#include <openvdb/math/Stencils.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "base/units.h"
#include "phantoms/fetal/fetal_head.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kAllowed = 1.0 * kMillimetre;

// As published (INTERGROWTH-21st).
double biparietal_m(double g) {
  return kMillimetre * (5.60878 + 0.158369 * g * g - 0.00256379 * g * g * g);
}

// A level set, sampled in the head frame.
class Caliper {
 public:
  Caliper(const Phantom& phantom, const std::string& surface, const FetalLandmarks& pose)
      : pose_(pose), grid_(find(phantom, surface)), stencil_(*grid_) {}

  double distance(const glm::dvec3& head_m) {
    const glm::dvec3 p = pose_.head_to_phantom * head_m + pose_.head_position_m;
    const openvdb::Vec3d index = grid_->worldToIndex({p.x, p.y, p.z});
    stencil_.moveTo(index);
    return stencil_.interpolation(index);
  }

  /// First zero crossing along the ray, by steps and bisection.
  glm::dvec3 first_hit(const glm::dvec3& from, const glm::dvec3& direction, double reach_m) {
    const double step = 0.3 * kMillimetre;
    for (double t = step; t < reach_m; t += step) {
      if (distance(from + t * direction) >= 0) continue;
      double low = t - step, high = t;
      for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        (distance(from + middle * direction) < 0 ? high : low) = middle;
      }
      return from + high * direction;
    }
    ADD_FAILURE() << "no hit";
    return from;
  }

  /// Point of the median plane's front profile at height y.
  glm::dvec3 profile(double y) {
    return first_hit({0, y, -15 * kMillimetre}, {0, 0, 1}, 60 * kMillimetre);
  }

  /// The profile's extreme between two heights; sign +1: deepest, -1: most prominent.
  glm::dvec3 extreme(double from, double to, double sign) {
    glm::dvec3 best = profile(from);
    for (double y = from; y <= to; y += 0.05 * kMillimetre) {
      const glm::dvec3 here = profile(y);
      if (sign * (here.z - best.z) > 0) best = here;
    }
    return best;
  }

 private:
  static FloatGrid::ConstPtr find(const Phantom& phantom, const std::string& name) {
    for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
      if (phantom.surfaces()[i].name == name) return phantom.grids().signed_distance[i];
    }
    throw std::logic_error("no surface " + name);
  }

  FetalLandmarks pose_;
  FloatGrid::ConstPtr grid_;
  openvdb::math::BoxStencil<const FloatGrid> stencil_;
};

class Biometry : public testing::TestWithParam<double> {
 protected:
  void SetUp() override {
    PhantomOptions options;
    options.gestational_age_weeks = GetParam();
    options.maternal_layer_m = 0;  // has no effect on the measures
    options.voxel_m = GetParam() == 21 ? 0.5 * kMillimetre : 1.0 * kMillimetre;
    phantom_ = std::make_unique<Phantom>(make_phantom(options));
    marks_ = fetal_landmarks(GetParam());
    mean_ = mean_face(GetParam());
  }
  Caliper caliper(const std::string& surface) { return {*phantom_, surface, marks_}; }

  std::unique_ptr<Phantom> phantom_;
  FetalLandmarks marks_;
  FaceMeasures mean_;
};

// Building is slow: one phantom per age for all measures.
TEST_P(Biometry, AgreesWithTheMeansOfTheAge) {
  {
    SCOPED_TRACE("BPD and HC: outer surface of the bone in the plane of BPD and OFD");
    Caliper skull = caliper("skull");
    const glm::dvec3 center = marks_.skull_center_m;
    double widest = 0, around = 0;
    for (double z = -10 * kMillimetre; z <= 10 * kMillimetre; z += 0.5 * kMillimetre) {
      const glm::dvec3 middle = center + glm::dvec3(0, 0, z);
      const glm::dvec3 left = skull.first_hit(middle - glm::dvec3(0.1, 0, 0), {1, 0, 0}, 0.1);
      const glm::dvec3 right = skull.first_hit(middle + glm::dvec3(0.1, 0, 0), {-1, 0, 0}, 0.1);
      widest = std::max(widest, glm::distance(left, right));
    }
    constexpr int kSteps = 360;
    glm::dvec3 first{0}, last{0};
    for (int i = 0; i <= kSteps; ++i) {
      const double angle = 2 * std::acos(-1.0) * i / kSteps;
      const glm::dvec3 outwards{std::cos(angle), 0, std::sin(angle)};
      const glm::dvec3 here = skull.first_hit(center + 0.1 * outwards, -outwards, 0.1);
      if (i > 0) around += glm::distance(last, here);
      if (i == 0) first = here;
      last = here;
    }
    EXPECT_LT(glm::distance(first, last), 1e-6);
    EXPECT_NEAR(widest, biparietal_m(GetParam()), kAllowed);
    EXPECT_NEAR(around, mean_[FaceMeasure::head_circumference] * kMillimetre, kAllowed);
  }
  {
    SCOPED_TRACE("orbits: inner and outer edges");
    Caliper eyes = caliper("eyes");
    double inner = 1, outer = 0;
    for (double y = -1 * kMillimetre; y <= 1 * kMillimetre; y += 0.25 * kMillimetre) {
      for (double z = -1 * kMillimetre; z <= 1 * kMillimetre; z += 0.25 * kMillimetre) {
        const glm::dvec3 level =
            glm::dvec3(0, marks_.eye_center_m.y + y, marks_.eye_center_m.z + z);
        const double right = eyes.first_hit(level, {1, 0, 0}, 0.1).x;
        const double left = eyes.first_hit(level, {-1, 0, 0}, 0.1).x;
        inner = std::min(inner, right - left);
        const double far_right = eyes.first_hit(level + glm::dvec3(0.05, 0, 0), {-1, 0, 0}, 0.1).x;
        const double far_left = eyes.first_hit(level - glm::dvec3(0.05, 0, 0), {1, 0, 0}, 0.1).x;
        outer = std::max(outer, far_right - far_left);
      }
    }
    EXPECT_NEAR(inner, mean_[FaceMeasure::interocular] * kMillimetre, kAllowed);
    EXPECT_NEAR(outer, mean_[FaceMeasure::binocular] * kMillimetre, kAllowed);
  }
  {
    SCOPED_TRACE("profile: base of the columella, tips of the lips, menton");
    Caliper skin = caliper("skin");
    const glm::dvec3 base =
        skin.extreme(marks_.nose_tip_m.y, marks_.upper_lip_m.y - 1 * kMillimetre, +1);
    const glm::dvec3 upper = skin.extreme(base.y, marks_.mouth_m.y, -1);
    const double fold = 0.5 * (marks_.lower_lip_m.y + marks_.menton_m.y);
    const glm::dvec3 lower = skin.extreme(marks_.mouth_m.y, fold, -1);
    const glm::dvec3 chin = skin.extreme(fold, marks_.menton_m.y - 2 * kMillimetre, -1);
    glm::dvec3 menton = chin;
    for (double back = 0; back <= 7 * kMillimetre; back += 0.1 * kMillimetre) {
      const glm::dvec3 below{0, marks_.menton_m.y + 4 * kMillimetre, chin.z + back};
      ASSERT_GT(skin.distance(below), 0) << "the chin stands free of the neck";
      const glm::dvec3 here = skin.first_hit(below, {0, -1, 0}, 0.03);
      if (here.y > menton.y) menton = here;
    }
    EXPECT_NEAR(glm::distance(base, upper), mean_[FaceMeasure::philtrum] * kMillimetre, kAllowed);
    EXPECT_NEAR(glm::distance(lower, menton), mean_[FaceMeasure::chin] * kMillimetre, kAllowed);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Weeks, Biometry, testing::Values(20, 21, 22, 22.4, 23, 24, 25, 26, 26.7, 27, 28, 30, 32.5, 34));

TEST(FaceMeasures, MeansAgreeWithThePublishedTables) {
  // Week, HC, BPD, OFD (INTERGROWTH-21st; OFD within 3 mm), IOD (Sukonpan), outer orbits (Mayden,
  // in whole millimetres), philtrum, chin (Gull), facial height, facial width (den Boogert), ear
  // (Chitkara), as printed or by the printed equations; mm.
  const double rows[][11] = {{20, 172, 48, 61, 12.5, 33, 5.0, 10.9, 25.8, 35.3, 14.2},
                             {21, 185, 52, 65, 13.0, 35, 5.3, 11.7, 27.6, 37.3, 15.3},
                             {24, 219, 61, 77, 14.5, 41.3, 6.1, 13.8, 32.7, 42.9, 18.5},
                             {28, 260, 74, 92, 16.6, 47.4, 7.0, 16.3, 38.5, 49.4, 22.8},
                             {30, 278, 79, 98, 17.6, 49.4, 7.4, 17.4, 41.1, 52.2, 25.0}};
  for (const auto& row : rows) {
    const FaceMeasures mean = mean_face(row[0]);
    EXPECT_NEAR(mean[FaceMeasure::head_circumference], row[1], 0.6);
    EXPECT_NEAR(mean[FaceMeasure::cephalic_index], 100 * row[2] / row[3], 3);
    EXPECT_NEAR(mean[FaceMeasure::interocular], row[4], 0.06);
    EXPECT_NEAR(mean[FaceMeasure::binocular], row[5], 0.9);
    EXPECT_NEAR(mean[FaceMeasure::philtrum], row[6], 0.06);
    EXPECT_NEAR(mean[FaceMeasure::chin], row[7], 0.06);
    EXPECT_NEAR(mean[FaceMeasure::facial_height], row[8], 0.1);
    EXPECT_NEAR(mean[FaceMeasure::zygomatic_width], row[9], 0.1);
    EXPECT_NEAR(mean[FaceMeasure::ear_length], row[10], 0.1);
  }
}

TEST(FaceMeasures, PerimeterOfKnownEllipses) {
  EXPECT_NEAR(ellipse_perimeter(2, 2), 2 * std::acos(-1.0), 1e-12);
  // Half axes 2 and 1: 4 a E(e) = 9.688448220547675.
  EXPECT_NEAR(ellipse_perimeter(4, 2), 9.688448220547675, 1e-5);
}

}  // namespace
}  // namespace wobblebench::phantoms
