// Tissue heard by a pulse that has lost its high frequencies.
#include <gtest/gtest.h>

#include <cmath>

#include "phantoms/phantom.h"
#include "sim/beam/point_spread.h"
#include "sim/echo/stick_propagation.h"
#include "sim/receive/band_loss.h"
#include "sim/scatterers/scatterer_field.h"
#include "tests/support/yardstick.h"

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

/// Peak in dB of a point on the middle stick, all tissue absorbing `nepers_per_m` at the centre
/// frequency, one way.
double point_level_db(const ScattererField& field,
                      const hw::AcquisitionPlan& points,
                      double range_m,
                      double nepers_per_m) {
  const BandLoss band(points.probe());
  std::vector<float> remaining, ratio;
  for (int i = 0; i < points.acquisition().samples_per_stick; ++i) {
    const double nepers = 2 * nepers_per_m * points.sample_range_m(i);
    remaining.push_back(static_cast<float>(std::exp(band.log_gain(nepers) - nepers)));
    ratio.push_back(static_cast<float>(band.frequency_ratio(nepers)));
  }
  Stick iq(remaining.size());
  const PointEcho point{points.geometry().to_cartesian({range_m, 0, 0}), 1};
  field.add_points({{points.geometry().stick(0, 0), 0},
                    points.acquisition().depth_m / static_cast<double>(iq.size()),
                    remaining,
                    {},
                    ratio},
                   {&point, 1},
                   iq);
  double peak = 0;
  for (const auto& value : iq) peak = std::max(peak, static_cast<double>(std::abs(value)));
  return 20 * std::log10(peak);
}

TEST(WidenedBeam, APointOutOfFocusIsAsLoudAsTheElementSumSays) {
  const hw::AcquisitionPlan points({}, {.depth_m = 0.17, .samples_per_stick = 4096});
  const auto phantom = phantoms::make_phantom({.name = "speckle_block", .voxel_m = 1e-3});
  const ScannedTissue tissue{std::make_shared<const TissueMap>(phantom, 2e-3, 0),
                             phantom.materials(),
                             {glm::dmat3(1.0), phantom.suggested_position_m()},
                             {}};
  SimulationOptions options;
  options.fidelity = Rung::scatterers;
  const ScattererField field(tissue, points, options);
  for (const auto& row : yardstick("attenuation")) {
    const double range_m = row.number("depth_mm") * 1e-3, alpha = row.number("alpha_db_cm_mhz");
    if (range_m < 30e-3 || alpha == 0 || alpha > 0.5) continue;
    const double nepers_per_m =
        alpha * points.probe().center_frequency_hz * 1e-6 * 100 * std::log(10.0) / 20;
    const double unattenuated_db = point_level_db(field, points, range_m, 0);
    EXPECT_NEAR(point_level_db(field, points, range_m, nepers_per_m) - unattenuated_db,
                row.number("level_db"),
                1)
        << range_m << " " << alpha;
  }
}

}  // namespace
}  // namespace wobblebench::sim
