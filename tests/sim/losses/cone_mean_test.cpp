// The shadow of a reflecting sheet that covers one half of the sector, or of the fan, against a sum
// over the waves and the sample points of the beam.
#include "sim/losses/cone_mean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "phantoms/material.h"
#include "sim/losses/losses.h"
#include "sim/optics/pulse_band.h"
#include "tests/sim/losses/shadow_sum.h"

namespace wobblebench::sim {
namespace {

constexpr double kConeDepth_m = 0.16;
constexpr double kSheet_m = 50e-3, kConeThick_m = 0.5e-3;  // range and thickness of the sheet

const hw::AcquisitionPlan& cone_plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

hw::AcquisitionPlan plan_of(int frames) {
  return {{}, {.sticks_per_frame = 9, .frames_per_volume = frames}};
}

/// Amplitude behind one face of the sheet over that before it, there and back.
constexpr double kFace = 0.03;

/// Absorb nothing; the second reflects so much that kFace remains, the third stands for fluid.
std::vector<phantoms::Material> materials() {
  phantoms::Material clear = phantoms::material("soft_tissue");
  clear.attenuation_db_per_cm_mhz = 0;
  phantoms::Material sheet = clear;
  const double r = std::sqrt(1 - kFace);
  sheet.impedance_rayl *= (1 + r) / (1 - r);
  return {clear, sheet, clear};
}

/// `beside`: the material of sticks that are not covered.
StickTrack track(bool covered, double sheet_m, phantoms::MaterialIndex beside) {
  StickTrack result;
  result.stretches = {{0, kConeDepth_m, beside}};
  if (covered) {
    const double behind_m = sheet_m + kConeThick_m;
    result.stretches = {{0, sheet_m, 0}, {sheet_m, behind_m, 1}, {behind_m, kConeDepth_m, 0}};
    result.interfaces = {{sheet_m, 0, 1}, {behind_m, 1, 0}};
  }
  return result;
}

/// A volume half covered by the sheet.
class Shadow {
 public:
  Shadow(
      const hw::AcquisitionPlan& plan,
      const std::function<bool(int frame, int line)>& covered,
      const std::function<double(int line)>& sheet_m = [](int) { return kSheet_m; },
      bool fluid_beside = false)
      : grid_(LossGrid::of(plan, kConeDepth_m)),
        cone_(ProbeOptics(plan), grid_),
        section_(ProbeOptics(plan), grid_, cone_),
        table_(grid_),
        band_(plan.probe()),
        covered_(covered) {
    const auto both = materials();
    const TissueLosses losses(plan, {}, both);
    for (int frame = 0; frame < grid_.frames; ++frame) {
      for (int line = 0; line < grid_.lines; ++line) {
        table_.record(
            frame, line, track(covered(frame, line), sheet_m(line), fluid_beside ? 2 : 0), losses);
      }
      table_.finish(frame);
    }
    ConeMean mean(cone_, section_, grid_, table_, band_);
    std::vector<float> frequency(size());
    log_gain_.resize(size() * static_cast<std::size_t>(grid_.frames));
    parts_.resize(ConeMean::parts_size(grid_) * static_cast<std::size_t>(grid_.frames));
    for (int frame = 0; frame < grid_.frames; ++frame) {
      mean.follow(frame, of(log_gain_, frame), frequency, of(parts_, frame));
    }
    for (int frame = 0; frame < grid_.frames; ++frame) {
      mean.add_elevation(frame, parts_, of(log_gain_, frame));
    }
  }

  /// Two-way amplitude on every stick of a frame, [line][node].
  std::vector<double> amplitudes(int frame) {
    const auto log_gain = of(log_gain_, frame);
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

  /// Correction for the paths and sample points beside the axis, natural logarithm, [line][node].
  std::span<const float> log_gain(int frame) { return of(log_gain_, frame); }

  const LossGrid& grid() const { return grid_; }

 private:
  std::size_t size() const { return static_cast<std::size_t>(grid_.lines * grid_.nodes); }
  std::span<float> of(std::vector<float>& values, int frame) const {
    const std::size_t each = values.size() / static_cast<std::size_t>(grid_.frames);
    return std::span(values).subspan(static_cast<std::size_t>(frame) * each, each);
  }

  LossGrid grid_;
  ApertureCone cone_;
  BeamSection section_;
  LossTable table_;
  BandLoss band_;
  std::function<bool(int, int)> covered_;
  std::vector<float> log_gain_;  ///< [frame][line][node]
  std::vector<float> parts_;
};

/// A difference would lose it, and the next step divide by 0. Ways that end with the fan take the
/// last frame whole.
TEST(ConeMean, ValuesBetweenSticksKeepTheSmallerOne) {
  const float near[] = {1, 1, 1, 1e-30F}, far[] = {1e-30F, 1e-30F, 0.5F, 1};
  const float share[] = {1, std::nextafter(1.0F, 0.0F), 0.25F, 0};
  float row[4];
  interpolate(near, far, share, 4, row);
  EXPECT_EQ(row[0], 1e-30F);
  EXPECT_GT(row[1], 0);
  EXPECT_EQ(row[2], 0.875F);
  EXPECT_EQ(row[3], 1e-30F);
  const float absorbed[] = {0, 0}, transmitted[] = {1, 1e-30F}, free[] = {1, 1};
  const float axis_gain = 1, axis_nepers = 0;
  float relative = 1, nepers = 0;
  step_paths(
      {free, absorbed, transmitted, absorbed}, 1, &axis_gain, &axis_nepers, 1, &relative, &nepers);
  EXPECT_EQ(relative, 1e-30F);
  EXPECT_EQ(nepers, 0);
  // The next step begins there.
  step_paths({transmitted, absorbed, transmitted, absorbed},
             1,
             &axis_gain,
             &axis_nepers,
             1,
             &relative,
             &nepers);
  EXPECT_FLOAT_EQ(relative, 1e-30F);
}

double wavelength_m() {
  return cone_plan().acquisition().sound_speed_m_s / cone_plan().probe().center_frequency_hz;
}

/// Paths are few, and the sheet's edge is known within a stick.
constexpr double kTolerance = 0.09;
/// The same within kNear_m behind the sheet.
constexpr double kNearTolerance = 0.12, kNear_m = 16e-3;

TEST(ConeMean, ShadowInTheImagePlaneIsThatOfTheBeam) {
  Shadow shadow(cone_plan(), [](int, int line) { return line < 32; });
  const auto found = shadow.amplitudes(18);
  const int nodes = shadow.grid().nodes;
  const double line_m = cone_plan().theta_step_rad() * (cone_plan().probe().radius_m + kSheet_m);
  const double focus_m = cone_plan().probe().transmit_focus_m;
  double softest = 0;
  for (int node = 0; node < nodes; ++node) {
    const double r = node * shadow.grid().step_m;
    if (r > kSheet_m && r < kSheet_m + 8e-3) continue;
    for (int line = 0; line < shadow.grid().lines; ++line) {
      const double aside_m = (line - 31.5) * line_m;
      const double expected =
          r < kSheet_m
              ? 1
              : amplitude_behind({ProbeOptics(cone_plan()).transmit_aperture_m(r), focus_m},
                                 {ProbeOptics(cone_plan()).receive_aperture_m(r), r},
                                 r,
                                 wavelength_m(),
                                 {kSheet_m, kFace, aside_m});
      const double amplitude = found[static_cast<std::size_t>(line * nodes + node)];
      const double tolerance = r < kSheet_m + kNear_m ? kNearTolerance : kTolerance;
      EXPECT_NEAR(amplitude, expected, tolerance) << line << " " << r;
      if (line == 29) softest = std::max(softest, amplitude);
    }
  }
  EXPECT_GT(softest, 0.05) << "on the axis alone it is " << kFace * kFace;
}

/// Largest difference on the middle line.
double worst_across_the_image_plane(int frames) {
  const auto plan = plan_of(frames);
  const int covered = frames / 2;
  Shadow shadow(plan, [=](int frame, int) { return frame < covered; });
  const ShadowAperture lens{plan.probe().element_height_m, plan.probe().elevation_focus_m};
  double worst = 0;
  for (int frame = covered - frames / 4; frame < covered + frames / 4; frame += 1 + frames / 48) {
    const auto found = shadow.amplitudes(frame);
    const double aside_m =
        (frame - covered + 0.5) * plan.phi_step_rad() * (plan.probe().wobble_radius_m + kSheet_m);
    for (int node = 0; node < shadow.grid().nodes; ++node) {
      const double r = node * shadow.grid().step_m;
      if (r < kSheet_m + 8e-3) continue;
      const double expected =
          amplitude_behind(lens, lens, r, wavelength_m(), {kSheet_m, kFace, aside_m});
      const auto i = static_cast<std::size_t>(4 * shadow.grid().nodes + node);
      worst = std::max(worst, std::abs(found[i] - expected));
    }
  }
  return worst;
}

TEST(ConeMean, ShadowAcrossTheImagePlaneIsThatOfTheBeam) {
  EXPECT_LT(worst_across_the_image_plane(145), kTolerance);
  // Frames of the default fan are 2.6 mm apart at the sheet.
  EXPECT_LT(worst_across_the_image_plane(37), 0.24);
}

TEST(ConeMean, AnEvenSheetIsThatOfTheAxis) {
  const LossGrid grid = LossGrid::of(cone_plan(), kConeDepth_m);
  Shadow shadow(cone_plan(), [](int, int) { return true; });
  const auto found = shadow.amplitudes(3);
  for (int i = 0; i < grid.lines * grid.nodes; ++i) {
    const bool behind = i % grid.nodes * grid.step_m > kSheet_m;
    ASSERT_EQ(found[static_cast<std::size_t>(i)], behind ? kFace * kFace : 1) << i;
  }
}

/// Where the beam has not met the sheet on either side of the axis.
TEST(ConeMean, NothingChangesInFrontOfAnObliqueSheet) {
  constexpr int kBeamLines = 4;
  const auto sheet_m = [](int line) { return 30e-3 + 1.9e-3 * line; };  // some 45 degrees
  Shadow shadow(
      cone_plan(), [](int, int) { return true; }, sheet_m);
  const auto& grid = shadow.grid();
  const auto log_gain = shadow.log_gain(18);
  for (int line = 0; line < grid.lines; ++line) {
    for (int node = 0; node * grid.step_m < sheet_m(line - kBeamLines); ++node) {
      const auto i = static_cast<std::size_t>(line * grid.nodes + node);
      EXPECT_NEAR(log_gain[i], 0, 1e-4) << line << " " << node;
    }
  }
}

/// Places beside a stick that lie in another material do not light its shadow: fluid beside a head
/// whose rim hides what is behind it.
TEST(ConeMean, FluidBesideAShadowDoesNotLightIt) {
  const auto dense = plan_of(145);
  const auto covered = [](int frame, int) { return frame < 72; };
  const auto straight = [](int) { return kSheet_m; };
  Shadow tissue(dense, covered), rim(dense, covered, straight, true);
  // 1.4 mm inside the shadow, 22 mm behind the sheet.
  const auto i = static_cast<std::size_t>(4 * rim.grid().nodes + 9);
  EXPECT_LT(rim.amplitudes(69)[i], 0.75 * tissue.amplitudes(69)[i]);
}

/// The aperture ends with the array: at the sector's edge only the paths from one side remain.
TEST(ConeMean, NoWayStartsBesideTheArray) {
  Shadow shadow(cone_plan(), [](int, int line) { return line > 0; });
  const auto found = shadow.amplitudes(18);
  const int nodes = shadow.grid().nodes;
  // The sheet covers all paths from the array except those within half a line of its end.
  EXPECT_LT(found[static_cast<std::size_t>(nodes - 1)], 0.3);
}

}  // namespace
}  // namespace wobblebench::sim
