// Scans of phantoms with and without the losses of the paths beside the axis.
#include "sim/losses/aperture_losses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "phantoms/placed_phantom.h"
#include "sim/losses/cone_mean.h"
#include "sim/optics/pulse_band.h"
#include "sim/probe_simulator.h"
#include "tests/sim/losses/shadow_sum.h"

namespace wobblebench::sim {
namespace {

constexpr int kSamples = 280;
constexpr double kDepth_m = 0.14;

hw::AcquisitionPlan plan(int lines, int frames, double sector_rad = 60 * kDegree) {
  return {{},
          {.depth_m = kDepth_m,
           .sector_rad = sector_rad,
           .sticks_per_frame = lines,
           .samples_per_stick = kSamples,
           .frames_per_volume = frames,
           .volumes = 2}};
}

/// The mean echo of tissue alone, as amplitudes.
SimulationOptions mean_echo() {
  SimulationOptions options;
  options.fidelity = Rung::field;
  options.speckle = options.interface_echo = options.low_pass = false;
  options.noise_db = kZeroAmplitude_db;
  options.tgc_db_per_cm_mhz = 0;
  options.output = hw::SampleScale::linear_envelope;
  options.full_scale_db = 0;
  return options;
}

VolumeSamples scan(const phantoms::PlacedPhantom& placed,
                   const hw::AcquisitionPlan& plan,
                   const SimulationOptions& options,
                   std::uint32_t volume = 0) {
  return ProbeSimulator(placed, plan, options).volume(volume);
}

constexpr double kThick_m = 8e-3;  // of the plate: 21 dB, most of it at low frequencies

phantoms::PlacedPhantom at_rest(const char* name) {
  const auto phantom = phantoms::make_phantom({.name = name, .thickness_m = kThick_m});
  return phantoms::still_at(phantom, phantom.suggested_position_m());
}

TEST(ApertureLosses, EvenTissueKeepsItsBytes) {
  for (const bool attenuation : {false, true}) {
    auto options = mean_echo();
    options.speckle = true;
    options.attenuation = attenuation;
    const auto block = at_rest("speckle_block");
    const auto narrow = plan(8, 4, 5 * kDegree);
    const auto with = scan(block, narrow, options);
    options.aperture_losses = false;
    EXPECT_EQ(with, scan(block, narrow, options)) << attenuation;
  }
}

TEST(ApertureLosses, ResultsDoNotDependOnThreads) {
  const auto phantom = phantoms::make_phantom({.name = "bone_plate"});
  auto placed = phantoms::still_at(phantom, phantom.suggested_position_m());
  for (const bool moves : {false, true}) {
    if (moves) {
      placed.motion = phantoms::Motion(phantoms::MotionOptions{.velocity_m_s = {0.02, 0, 0}}, {});
    }
    auto options = mean_echo();
    options.threads = 1;
    const auto one = scan(placed, plan(16, 9), options, 1);
    for (const int threads : {2, 5}) {
      options.threads = threads;
      EXPECT_EQ(one, scan(placed, plan(16, 9), options, 1)) << moves << " " << threads;
    }
  }
}

/// Corrections of a volume in which every frame is followed, [frame][line][node].
std::vector<float> all_corrections(const ScannedTissue& tissue,
                                   const hw::AcquisitionPlan& plan,
                                   const SimulationOptions& options) {
  const LossGrid grid = LossGrid::of(plan, kDepth_m);
  const ProbeOptics optics(plan);
  const ApertureCone cone(optics, grid);
  const BeamSection section(optics, grid, cone);
  const BandLoss band(plan.probe());
  const TissueLosses losses(plan, options, tissue.materials);
  LossTable table(grid);
  StickTrack track;
  for (int i = 0; i < plan.sticks_per_volume(); ++i) {
    const hw::StickIndex stick = plan.index(static_cast<std::uint64_t>(i));
    follow(tissue, stick_ray(plan, stick), kDepth_m, track, Surfaces::crossed);
    table.record(static_cast<int>(stick.frame), static_cast<int>(stick.line), track, losses);
  }
  for (int frame = 0; frame < grid.frames; ++frame) table.finish(frame);
  ConeMean mean(cone, section, grid, table, band);
  const auto frames = static_cast<std::size_t>(grid.frames);
  const auto size = static_cast<std::size_t>(grid.lines * grid.nodes);
  std::vector<float> gain(frames * size), frequency(size),
      parts(frames * ConeMean::parts_size(grid));
  for (std::size_t f = 0; f < frames; ++f) {
    mean.follow(
        static_cast<int>(f),
        std::span(gain).subspan(f * size, size),
        frequency,
        std::span(parts).subspan(f * ConeMean::parts_size(grid), ConeMean::parts_size(grid)));
  }
  for (std::size_t f = 0; f < frames; ++f) {
    mean.add_elevation(static_cast<int>(f), parts, std::span(gain).subspan(f * size, size));
  }
  return gain;
}

/// Frames far from whatever differs are not followed, and must not be read.
TEST(ApertureLosses, WhatIsSkippedChangesNothing) {
  const auto phantom = phantoms::make_phantom({.name = "sphere", .radius_m = 3e-3});
  hw::ProbeOptions low;  // few frames in reach
  low.element_height_m = 4e-3;
  const hw::AcquisitionPlan dense(low, plan(5, 145, 6 * kDegree).acquisition());
  const auto options = mean_echo();
  const ScannedTissue tissue{std::make_shared<const TissueMap>(phantom, 2e-3, 0),
                             phantom.materials(),
                             {glm::dmat3(1.0), {0, 0, dense.probe().radius_m + 110e-3}},
                             {}};
  const auto expected = all_corrections(tissue, dense, options);
  const auto volume = ApertureLosses(tissue, ProbeOptics(dense), options, kDepth_m).volume(0);
  const std::size_t nodes = expected.size() / static_cast<std::size_t>(dense.sticks_per_volume());
  int corrected = 0;
  for (int i = 0; i < dense.sticks_per_volume(); ++i) {
    const hw::StickIndex stick = dense.index(static_cast<std::uint64_t>(i));
    const auto found = volume->of(stick).log_gain;
    for (std::size_t k = 0; k < nodes; ++k) {
      const std::size_t at = (stick.frame * 5 + stick.line) * nodes + k;
      ASSERT_EQ(found.empty() ? 0 : found[k], expected[at]) << stick.frame << " " << k;
    }
    corrected += !found.empty();
  }
  EXPECT_GT(corrected, 50);
  EXPECT_LT(corrected, dense.sticks_per_volume() / 2);
}

/// Distance over which a profile rises from 20 to 90 % of its end.
double rise_m(const std::vector<double>& x_m, const std::vector<double>& profile) {
  const auto crossing = [&](double level) {
    const auto i = static_cast<std::size_t>(
        std::find_if(profile.begin(), profile.end(), [&](double v) { return v > level; }) -
        profile.begin());
    const double share = (level - profile[i - 1]) / (profile[i] - profile[i - 1]);
    return x_m[i - 1] + share * (x_m[i] - x_m[i - 1]);
  };
  return crossing(0.9 * profile.back()) - crossing(0.2 * profile.back());
}

/// The phantom bone_plate ends 15 mm aside of the axis, its front 40 mm below the face. Paths that
/// pass the edge of its front diverge from the plate.
struct Edge {
  double theta_rad = std::atan2(15e-3, 80e-3);
  double to_plate_m = std::hypot(15e-3, 80e-3) - 40e-3;  ///< range of the edge
};

/// Two-way amplitude on a stick behind the edge at a range. The plate lets little through.
double amplitude_at(const hw::AcquisitionPlan& plan, double range_m, double theta_rad) {
  const Edge edge;
  const ProbeOptics optics(plan);
  const double aside_m = (theta_rad - edge.theta_rad) * (40e-3 + edge.to_plate_m);
  constexpr double kThroughPlate = 0.02;
  return amplitude_behind({optics.transmit_aperture_m(range_m), plan.probe().transmit_focus_m},
                          {optics.receive_aperture_m(range_m), range_m},
                          range_m,
                          plan.acquisition().sound_speed_m_s / plan.probe().center_frequency_hz,
                          {edge.to_plate_m, kThroughPlate, aside_m});
}

struct Profile {
  std::vector<double> x_m;  ///< across the sticks, at the edge's range
  std::vector<double> found;
  std::vector<double> expected;
};

Profile profile_at(double range_m, bool aperture_losses) {
  const auto sector = plan(121, 9);
  auto options = mean_echo();
  options.aperture_losses = aperture_losses;
  const auto samples = scan(at_rest("bone_plate"), sector, options);
  const auto k = static_cast<int>(range_m / sector.sample_spacing_m());
  const Edge edge;
  Profile profile;
  for (int line = 60; line < 112; ++line) {
    const double theta_rad = sector.theta_rad(line);
    profile.x_m.push_back(theta_rad * (40e-3 + edge.to_plate_m));
    profile.found.push_back(
        static_cast<double>(samples[static_cast<std::size_t>((4 * 121 + line) * kSamples + k)]));
    profile.expected.push_back(amplitude_at(sector, range_m, theta_rad));
  }
  return profile;
}

TEST(ApertureLosses, TheShadowsEdgeIsAsSoftAsTheBeam) {
  for (const double range_m : {70e-3, 80e-3, 95e-3}) {
    const Profile profile = profile_at(range_m, true), axis = profile_at(range_m, false);
    const double expected_m = rise_m(profile.x_m, profile.expected);
    EXPECT_NEAR(rise_m(profile.x_m, profile.found), expected_m, 0.2 * expected_m) << range_m;
    EXPECT_LT(rise_m(axis.x_m, axis.found), 0.5 * expected_m) << "the axis alone, " << range_m;
  }
}

}  // namespace
}  // namespace wobblebench::sim
