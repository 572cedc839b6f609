// The element sum compared with closed forms, and the rung `scatterers` compared with it.
#include "sim/rungs/reference_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "sim/optics/pulse_band.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/speckle/iq_field.h"

namespace wobblebench::sim {
namespace {

using Stick = std::vector<std::complex<float>>;

/// Three sticks close together, the middle one along the axis of the probe.
hw::AcquisitionPlan plan_of(int samples = 512) {
  hw::AcquisitionOptions acquisition;
  acquisition.samples_per_stick = samples;
  acquisition.sticks_per_frame = 3;
  acquisition.frames_per_volume = 1;
  acquisition.sector_rad = 0.02;
  return {{}, acquisition};
}

/// A sphere of tissue on the axis.
ScannedTissue sphere(const hw::AcquisitionPlan& plan, double radius_m, double range_m) {
  const auto phantom = phantoms::make_phantom({.name = "sphere", .radius_m = radius_m});
  return {std::make_shared<const TissueMap>(phantom, 1e-3, 0),
          phantom.materials(),
          {glm::dmat3(1.0), {0, 0, plan.probe().radius_m + range_m}},
          {}};
}

SimulationOptions by_elements() {
  SimulationOptions options;
  options.fidelity = Rung::reference;
  return options;
}

/// IQ samples of one scatterer of amplitude 1, off the axis of the middle stick.
Stick echo_of(const hw::AcquisitionPlan& plan,
              double range_m,
              double lateral_m,
              double elevation_m) {
  static const ScannedTissue tissue = sphere(plan_of(), 1e-3, 75e-3);
  const auto field = make_iq_field(plan);
  Stick iq(static_cast<std::size_t>(field.samples));
  const std::vector<float> left(iq.size(), 1.0f);
  const TimedRay line = stick_ray(plan, {0, 0, 1});
  const AcrossStick across = across_stick(line.ray);
  const PointEcho point{
      line.ray.at(range_m) + lateral_m * across.lateral + elevation_m * across.elevation, 1};
  ReferenceScene(tissue, ProbeOptics(plan), by_elements())
      .add_points({line, field.spacing_m, left, {}}, {&point, 1}, iq);
  return iq;
}

double peak_of(const Stick& iq) {
  float peak = 0;
  for (const auto& value : iq) peak = std::max(peak, std::abs(value));
  return static_cast<double>(peak);
}

/// Twice the offset at which a falling response is one half of its value at 0.
double full_width(const std::function<double(double)>& response, double most) {
  const double half = response(0) / 2;
  double low = 0, high = most;
  for (int i = 0; i < 8; ++i) {
    const double middle = (low + high) / 2;
    (response(middle) > half ? low : high) = middle;
  }
  return low + high;
}

TEST(Reference, OnTheAxisThePeakIsTheAmplitude) {
  const auto plan = plan_of(4096);
  for (double range_m : {40e-3, 75e-3, 120e-3}) {
    EXPECT_NEAR(peak_of(echo_of(plan, range_m, 0, 0)), 1, 0.015) << range_m;
  }
}

TEST(Reference, InTheFocusThePhaseIsThatOfTheRange) {
  const auto plan = plan_of(2048);
  const double spacing_m = make_iq_field(plan).spacing_m;
  // The range of a sample.
  const auto sample = static_cast<std::size_t>(75e-3 / spacing_m);
  const double exact_m = (static_cast<double>(sample) + 0.5) * spacing_m;
  const double cycles = 2 * exact_m * plan.probe().center_frequency_hz / 1540;
  const std::complex<double> expected = std::polar(1.0, -2 * kPi * (cycles - std::floor(cycles)));
  const Stick iq = echo_of(plan, exact_m, 0, 0);
  EXPECT_LT(std::abs(std::complex<double>(iq[sample]) - expected), 0.1);
}

TEST(Reference, WidthsAtTheFociAreThoseOfTheElementSum) {
  const auto plan = plan_of(4096);
  const double focus_m = 75e-3;
  const double lateral =
      full_width([&](double x) { return peak_of(echo_of(plan, focus_m, x, 0)); }, 3e-3);
  // tests/yardstick/point_widths.csv, the axis at 75 mm.
  EXPECT_NEAR(lateral / 1.6762e-3, 1, 0.03);
  const double elevation =
      full_width([&](double y) { return peak_of(echo_of(plan, focus_m, 0, y)); }, 4e-3);
  EXPECT_NEAR(elevation / 2.2307e-3, 1, 0.03);
  const Stick iq = echo_of(plan, focus_m, 0, 0);
  double area = 0;
  for (const auto& value : iq) area += static_cast<double>(std::abs(value));
  // A Gaussian's area is peak * FWHM * sqrt(pi / (4 ln 2)).
  const double axial = area * make_iq_field(plan).spacing_m / peak_of(iq) / 1.0645;
  EXPECT_NEAR(axial / axial_fwhm_m(plan), 1, 0.05);
}

/// Envelopes of three sticks through a small sphere of tissue, by either rung.
std::vector<double> envelopes(double range_m, Rung rung, bool side_lobes) {
  const auto plan = plan_of();
  const ScannedTissue tissue = sphere(plan, 2e-3, range_m);
  SimulationOptions options;
  options.fidelity = rung;
  options.side_lobes = side_lobes;
  const auto grid = make_iq_field(plan);
  const std::vector<float> left(static_cast<std::size_t>(grid.samples), 1.0f);
  std::vector<double> result;
  for (std::uint32_t line = 0; line < 3; ++line) {
    const StickPath path{stick_ray(plan, {0, 0, line}), grid.spacing_m, left, {}};
    Stick iq(left.size());
    if (rung == Rung::reference) {
      ReferenceScene(tissue, ProbeOptics(plan), options).add_echoes(path, iq);
    } else {
      ScattererField(tissue, ProbeOptics(plan), options).add_echoes(path, iq);
    }
    const int first = static_cast<int>((range_m - 4e-3) / grid.spacing_m);
    const int last = static_cast<int>((range_m + 4e-3) / grid.spacing_m);
    for (int k = first; k < last; ++k) {
      result.push_back(static_cast<double>(std::abs(iq[static_cast<std::size_t>(k)])));
    }
  }
  return result;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double mean_a = 0, mean_b = 0, ab = 0, aa = 0, bb = 0;
  const auto n = static_cast<double>(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

TEST(Reference, AgreesWithTheRungScatterers) {
  const auto agreement = [](double range_m, bool side_lobes) {
    return correlation(envelopes(range_m, Rung::scatterers, side_lobes),
                       envelopes(range_m, Rung::reference, side_lobes));
  };
  EXPECT_GE(agreement(75e-3, false), 0.98);
  EXPECT_GE(agreement(75e-3, true), 0.98);
  EXPECT_GE(agreement(100e-3, false), 0.98);
  // Before both foci wave fronts are more curved than the beam table represents.
  EXPECT_GE(agreement(50e-3, false), 0.95);
}

TEST(Reference, RefusesScenesThatTakeTooLong) {
  const hw::AcquisitionPlan whole({}, {});
  const auto block = phantoms::make_phantom({.name = "speckle_block"});
  const ScannedTissue tissue{std::make_shared<const TissueMap>(block, 1e-3, 0),
                             block.materials(),
                             {glm::dmat3(1.0), block.suggested_position_m()},
                             {}};
  EXPECT_THROW(ReferenceScene(tissue, ProbeOptics(whole), by_elements()), InvalidOption);
}

}  // namespace
}  // namespace wobblebench::sim
