// The echo of rough interfaces at a track's nodes, in single precision, against diffuse_echo().
#include "sim/rungs/beam_nodes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/losses/losses.h"
#include "sim/losses/stick_losses.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::sim {
namespace {

constexpr double kSpacing_m = 0.1e-3;
constexpr int kSamples = 1000;
constexpr float kBefore_m = 0.2e-3F;  // from the nodes to the surface behind them
constexpr int kAngles = 18;

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

/// A surface of material 1 in material 0, whose angle of incidence grows by 5 degrees a node.
StickTrack tilting(bool entering) {
  StickTrack track;
  track.stretches = {{0, kSamples * kSpacing_m, entering ? 0 : 1}};
  track.pieces = {{50e-3, 60e-3, 0, 0, 1, kAngles}};
  track.layers = {{0, 1, 0}};
  for (int n = 0; n < kAngles; ++n) {
    const auto angle = static_cast<float>(5 * n * kDegree);
    const float towards = entering ? -1.0f : 1.0f;
    const float lateral = 0.6f * std::sin(angle), elevation = 0.8f * std::sin(angle);
    track.nodes.push_back({-towards * kBefore_m, towards * std::cos(angle), lateral, elevation});
  }
  return track;
}

class RoughInterface : public testing::TestWithParam<const char*> {};

TEST_P(RoughInterface, EchoesByItsDiffusePart) {
  const std::vector materials{phantoms::material("amniotic_fluid"), phantoms::material(GetParam())};
  const SimulationOptions options;
  for (const bool entering : {true, false}) {
    const StickTrack track = tilting(entering);
    StickLosses losses(plan(), options, materials, kSpacing_m, kSamples);
    losses.compute(track);
    BeamNodes nodes(ProbeOptics(plan()), options, materials, kSpacing_m, kSamples, 4e-3);
    const BeamAtSamples beam(plan(), BeamProfile(ProbeOptics(plan())), kSpacing_m, kSamples);
    nodes.compute(track, losses, beam.of(0));
    const auto& before = materials[entering ? 0 : 1];
    const auto& behind = materials[entering ? 1 : 0];
    const double pulse_m = power_sigma(axial_fwhm_m(plan()));
    for (int n = 0; n < kAngles; ++n) {
      const BeamNodes::Node& node = nodes.of(track.layers[0])[n];
      const double cosine = std::cos(5 * n * kDegree);
      const double width_m = static_cast<double>(track.nodes[static_cast<std::size_t>(n)].value_m /
                                                 node.distance_sigmas);
      const double mean = diffuse_echo(before, behind, cosine);
      const double expected = mean_power_gain(options) * mean * mean * pulse_m * cosine / width_m;
      EXPECT_NEAR(node.interface_power, expected, 1e-4 * expected + 1e-12)
          << entering << " " << 5 * n;
      EXPECT_GE(width_m, 0.999 * pulse_m * cosine) << 5 * n;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Materials,
                         RoughInterface,
                         testing::Values("soft_tissue", "cortical_bone", "fetal_skin", "fat"));

}  // namespace
}  // namespace wobblebench::sim
