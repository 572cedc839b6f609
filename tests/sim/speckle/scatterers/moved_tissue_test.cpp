// Speckle of tissue that moves along the stick, against the element sum.
#include <gtest/gtest.h>

#include <complex>
#include <memory>
#include <vector>

#include "base/units.h"
#include "phantoms/phantom.h"
#include "sim/optics/pulse_band.h"
#include "sim/speckle/scatterers/scatterer_field.h"
#include "sim/tissue/scanned_tissue.h"
#include "sim/tissue/tissue_map.h"
#include "tests/support/yardstick.h"

namespace wobblebench::sim {
namespace {

using Stick = std::vector<std::complex<float>>;

constexpr int kMoved = 8;  ///< samples: tests/yardstick/moved.csv

/// Few sticks about the axis.
const hw::AcquisitionPlan& moved_plan() {
  static const hw::AcquisitionPlan shared({},
                                          {.depth_m = 0.09,
                                           .sector_rad = 4 * kDegree,
                                           .fan_rad = 4 * kDegree,
                                           .sticks_per_frame = 3,
                                           .samples_per_stick = 512,
                                           .frames_per_volume = 3});
  return shared;
}

/// The middle stick, of tissue that is so much farther away.
Stick scanned(double moved_m, bool all_octaves, std::uint64_t seed) {
  static const auto phantom = phantoms::make_phantom({.name = "speckle_block", .voxel_m = 1e-3});
  static const auto map = std::make_shared<const TissueMap>(phantom, 2e-3, 0);
  const glm::dvec3 position_m = phantom.suggested_position_m() + glm::dvec3(0, 0, moved_m);
  SimulationOptions options;
  options.fidelity = Rung::scatterers;
  options.seed = seed;
  ScattererSettings settings;
  settings.all_octaves = all_octaves;
  const ScannedTissue tissue{map, phantom.materials(), {glm::dmat3(1.0), position_m}, {}};
  const ScattererField field(tissue, ProbeOptics(moved_plan()), options, settings);
  const int rate = iq_oversampling(moved_plan());
  Stick iq(static_cast<std::size_t>(512 * rate));
  const std::vector<float> remaining(iq.size(), 1.0f);
  field.add_echoes(
      {stick_ray(moved_plan(), {0, 1, 1}), moved_plan().sample_spacing_m() / rate, remaining, {}},
      iq);
  return iq;
}

/// Squared correlation of echoes from 44 to 84 mm, before and after.
double followed(bool all_octaves) {
  const auto rate = static_cast<std::size_t>(iq_oversampling(moved_plan()));
  const auto sample = [&](double range_m) {
    return rate * static_cast<std::size_t>(range_m / moved_plan().sample_spacing_m());
  };
  std::complex<double> product = 0;
  double before = 0, after = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Stick still = scanned(0, all_octaves, seed);
    const Stick moved = scanned(kMoved * moved_plan().sample_spacing_m(), all_octaves, seed);
    for (std::size_t i = sample(44e-3); i < sample(84e-3); ++i) {
      const std::complex<double> a(still[i]), b(moved[i + kMoved * rate]);
      product += a * std::conj(b);
      before += std::norm(a);
      after += std::norm(b);
    }
  }
  return std::norm(product) / (before * after);
}

TEST(MovedTissue, KeepsItsSpeckleAsTheBeamChangesWithRange) {
  const auto rows = yardstick("moved");
  double expected = 0;
  for (const auto& row : rows)
    expected += row.number("correlation") / static_cast<double>(rows.size());
  // Rows and columns of the beam's table are not interpolated.
  EXPECT_NEAR(followed(true), expected, 0.015);
}

/// A density that follows the resolution cell by 10 % a millimetre keeps 0.94 of it.
TEST(MovedTissue, ExchangesFewOfItsScatterers) {
  EXPECT_GT(followed(false), 0.955);
}

}  // namespace
}  // namespace wobblebench::sim
