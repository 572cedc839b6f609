// The shadow of a reflecting sheet that covers one half of the sector, or of the fan, against the
// uncovered share of the cone's section.
#include "sim/aperture/cone_mean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "phantoms/material.h"
#include "sim/beam/point_spread.h"
#include "sim/receive/tissue_losses.h"

namespace wobblebench::sim {
namespace {

constexpr double kDepth_m = 0.16;
constexpr double kSheet_m = 50e-3, kThick_m = 0.5e-3;  // range and thickness of the sheet

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

/// Amplitude behind one face of the sheet over that before it, there and back.
constexpr double kFace = 0.03;

/// Absorb nothing; the second reflects so much that kFace remains.
std::vector<phantoms::Material> materials() {
  phantoms::Material clear = phantoms::material("soft_tissue");
  clear.attenuation_db_per_cm_mhz = 0;
  phantoms::Material sheet = clear;
  const double r = std::sqrt(1 - kFace);
  sheet.impedance_rayl *= (1 + r) / (1 - r);
  return {clear, sheet};
}

StickTrack track(bool covered) {
  StickTrack result;
  result.stretches = {{0, kDepth_m, 0}};
  if (covered) {
    const double behind_m = kSheet_m + kThick_m;
    result.stretches = {{0, kSheet_m, 0}, {kSheet_m, behind_m, 1}, {behind_m, kDepth_m, 0}};
    result.interfaces = {{kSheet_m, 0, 1}, {behind_m, 1, 0}};
  }
  return result;
}

/// A volume half covered by the sheet.
class Shadow {
 public:
  explicit Shadow(const std::function<bool(int frame, int line)>& covered)
      : grid_(LossGrid::of(plan(), kDepth_m)),
        cone_(plan(), grid_),
        table_(grid_),
        band_(plan().probe()),
        covered_(covered) {
    const auto both = materials();
    const TissueLosses losses(plan(), {}, both);
    for (int frame = 0; frame < grid_.frames; ++frame) {
      for (int line = 0; line < grid_.lines; ++line) {
        table_.record(frame, line, track(covered(frame, line)), losses);
      }
      table_.finish(frame);
    }
  }

  /// Two-way amplitude on every stick of a frame, [line][node].
  std::vector<double> amplitudes(int frame) const {
    const auto size = static_cast<std::size_t>(grid_.lines * grid_.nodes);
    std::vector<float> log_gain(size), frequency(size);
    ConeMean mean(cone_, grid_, table_, band_);
    mean.compute(frame, log_gain, frequency);
    std::vector<double> result;
    for (int line = 0; line < grid_.lines; ++line) {
      for (int node = 0; node < grid_.nodes; ++node) {
        const bool behind = node * grid_.step_m > kSheet_m && covered_(frame, line);
        const auto i = static_cast<std::size_t>(line * grid_.nodes + node);
        result.push_back((behind ? kFace * kFace : 1) * std::exp(static_cast<double>(log_gain[i])));
      }
    }
    return result;
  }

  const LossGrid& grid() const { return grid_; }

 private:
  LossGrid grid_;
  ApertureCone cone_;
  LossTable table_;
  BandLoss band_;
  std::function<bool(int, int)> covered_;
};

/// Mean one-way amplitude at a range, over an aperture of a given width. The sheet's edge lies
/// `aside_m` from the axis, the uncovered side positive.
double mean_through(double aperture_m, double range_m, double aside_m) {
  const double half_m = 0.5 * aperture_m * (1 - kSheet_m / range_m);
  const double free = std::clamp(0.5 * (1 + aside_m / half_m), 0.0, 1.0);
  return free + (1 - free) * kFace;
}

/// The same for transmission: the sum of the waves at the point, each with its
/// phase.
double transmitted_through(double range_m, double aside_m) {
  constexpr int kWaves = 4000;
  const double aperture_m = transmit_aperture_m(plan(), range_m);
  const double curvature_per_m = 1 / range_m - 1 / plan().probe().transmit_focus_m;
  const double per_m2 = std::numbers::pi * curvature_per_m * plan().probe().center_frequency_hz /
                        plan().acquisition().sound_speed_m_s;
  std::complex<double> all, through;
  for (int i = 0; i < kWaves; ++i) {
    const double from_m = ((i + 0.5) / kWaves - 0.5) * aperture_m;
    const auto wave = std::polar(1.0, per_m2 * from_m * from_m);
    const bool free = from_m * (1 - kSheet_m / range_m) > -aside_m;
    all += wave;
    through += free ? wave : kFace * wave;
  }
  return std::abs(through) / std::abs(all);
}

/// Ways are few, and the sheet's edge is known within a stick.
constexpr double kTolerance = 0.09;
/// Out of focus the sum of waves oscillates beside the sheet's edge (Fresnel fringes); the mean
/// over the waves in phase does not.
constexpr double kFringes = 0.14;

TEST(ConeMean, ShadowInTheImagePlaneIsTheUncoveredShareOfTheCone) {
  const Shadow shadow([](int, int line) { return line < 32; });
  const auto found = shadow.amplitudes(18);
  const int nodes = shadow.grid().nodes;
  const double line_m = plan().theta_step_rad() * (plan().probe().radius_m + kSheet_m);
  double softest = 0;
  for (int node = 0; node < nodes; ++node) {
    const double r = node * shadow.grid().step_m;
    if (r > kSheet_m && r < kSheet_m + 16e-3) continue;
    for (int line = 0; line < shadow.grid().lines; ++line) {
      const double aside_m = (line - 31.5) * line_m;
      const double expected = r < kSheet_m
                                  ? 1
                                  : transmitted_through(r, aside_m) *
                                        mean_through(receive_aperture_m(plan(), r), r, aside_m);
      const double amplitude = found[static_cast<std::size_t>(line * nodes + node)];
      EXPECT_NEAR(amplitude, expected, kFringes) << line << " " << r;
      if (line == 29) softest = std::max(softest, amplitude);
    }
  }
  EXPECT_GT(softest, 0.05) << "on the axis alone it is " << kFace * kFace;
}

TEST(ConeMean, ShadowAcrossTheImagePlaneIsTheUncoveredShareOfTheCone) {
  const Shadow shadow([](int frame, int) { return frame < 18; });
  const int middle = shadow.grid().lines / 2;
  const int nodes = shadow.grid().nodes;
  const double to_axis_m = plan().probe().wobble_radius_m + kSheet_m;
  for (int frame = 0; frame < shadow.grid().frames; ++frame) {
    const auto found = shadow.amplitudes(frame);
    const double aside_m = (frame - 17.5) * plan().phi_step_rad() * to_axis_m;
    for (int node = 0; node < nodes; ++node) {
      const double r = node * shadow.grid().step_m;
      if (r < kSheet_m + 16e-3) continue;
      const double one_way = mean_through(plan().probe().element_height_m, r, aside_m);
      EXPECT_NEAR(
          found[static_cast<std::size_t>(middle * nodes + node)], one_way * one_way, kTolerance)
          << frame << " " << r;
    }
  }
}

TEST(ConeMean, AnEvenSheetIsThatOfTheAxis) {
  const LossGrid grid = LossGrid::of(plan(), kDepth_m);
  const Shadow shadow([](int, int) { return true; });
  const auto found = shadow.amplitudes(3);
  for (int i = 0; i < grid.lines * grid.nodes; ++i) {
    const bool behind = i % grid.nodes * grid.step_m > kSheet_m;
    ASSERT_EQ(found[static_cast<std::size_t>(i)], behind ? kFace * kFace : 1) << i;
  }
}

/// The aperture ends with the array: at the sector's edge only ways from one side are left.
TEST(ConeMean, NoWayStartsBesideTheArray) {
  const Shadow shadow([](int, int line) { return line > 0; });
  const auto found = shadow.amplitudes(18);
  const int nodes = shadow.grid().nodes;
  // The sheet covers all the array's ways but those within half a line of its end.
  EXPECT_LT(found[static_cast<std::size_t>(nodes - 1)], 0.3);
}

}  // namespace
}  // namespace wobblebench::sim
