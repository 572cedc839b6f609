// Tissue heard by a pulse that has lost its high frequencies.
#include <gtest/gtest.h>

#include <cmath>

#include "phantoms/phantom.h"
#include "sim/beam/point_spread.h"
#include "sim/echo/stick_propagation.h"
#include "sim/scatterers/scatterer_field.h"

namespace wobblebench::sim {
namespace {

using Stick = std::vector<std::complex<float>>;

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan shared({}, {});
  return shared;
}

/// Number of contributing scatterers and mean power of sticks whose frequency falls to `lowest`.
struct Heard {
  std::uint64_t count = 0;
  double power = 0;
};

Heard heard(const ScattererField& field, float lowest) {
  const auto samples =
      static_cast<std::size_t>(plan().acquisition().samples_per_stick * iq_oversampling(plan()));
  const double spacing_m = plan().acquisition().depth_m / static_cast<double>(samples);
  const std::vector<float> remaining(samples, 1.0f);
  std::vector<float> ratio;
  for (std::size_t i = 0; i < samples; ++i) {
    ratio.push_back(1 - (1 - lowest) * static_cast<float>(i) / static_cast<float>(samples));
  }
  Heard all;
  for (std::uint32_t frame = 10; frame < 28; ++frame) {
    for (std::uint32_t line = 26; line < 38; ++line) {
      Stick iq(samples);
      field.add_echoes(
          {stick_ray(plan(), {0, frame, line}), spacing_m, remaining, {}, ratio}, iq, &all.count);
      for (std::size_t i = samples / 2; i < samples * 5 / 8; ++i) {
        all.power += static_cast<double>(std::norm(iq[i]));
      }
    }
  }
  return all;
}

TEST(WidenedBeam, HearsAsManyScatterersOfMoreTissueAtTheSameLevel) {
  const auto phantom = phantoms::make_phantom({.name = "speckle_block", .voxel_m = 1e-3});
  const ScannedTissue tissue{std::make_shared<const TissueMap>(phantom, 2e-3, 0),
                             phantom.materials(),
                             {glm::dmat3(1.0), phantom.suggested_position_m()},
                             {}};
  SimulationOptions options;
  options.fidelity = Rung::scatterers;
  const ScattererField field(tissue, plan(), options);
  const Heard sent = heard(field, 1), lower = heard(field, 0.5f);
  // Half way along, the beam is a third wider in both directions: of scatterers as dense it would
  // hear some twice as many.
  EXPECT_NEAR(static_cast<double>(lower.count),
              static_cast<double>(sent.count),
              0.25 * static_cast<double>(sent.count));
  EXPECT_NEAR(lower.power / sent.power, 1, 0.1);
}

}  // namespace
}  // namespace wobblebench::sim
