// Fully developed speckle compared with published statistics of its envelope (docs/references.md
// [7]).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hw/probe/probe.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"
#include "sim/probe_simulator.h"
#include "sim/speckle/iq_field.h"
#include "sim/speckle/line_covariance.h"

namespace wobblebench::sim {
namespace {

SimulationOptions linear() {
  SimulationOptions options;
  options.output = hw::SampleScale::linear_envelope;
  options.noise_db = kZeroAmplitude_db;
  options.low_pass = false;
  return options;
}

ProbeSimulator speckle_block(const SimulationOptions& options, const hw::AcquisitionPlan& plan) {
  const auto phantom = phantoms::make_phantom({.name = "speckle_block"});
  return {phantoms::still_at(phantom, phantom.suggested_position_m()), plan, options};
}

/// mean / sigma over the middle sticks at each range, averaged over the ranges: attenuation, time
/// gain and the beam change the mean with range, and towards the end of the array with the angle,
/// not the ratio.
double speckle_snr(const VolumeSamples& samples, const hw::AcquisitionPlan& plan) {
  constexpr double kMiddle_rad = 8 * kDegree;
  const int per_stick = plan.acquisition().samples_per_stick;
  std::vector<std::size_t> middle;
  for (int i = 0; i < plan.sticks_per_volume(); ++i) {
    const auto line = static_cast<int>(plan.index(static_cast<std::uint64_t>(i)).line);
    if (std::abs(plan.theta_rad(line)) < kMiddle_rad) middle.push_back(static_cast<std::size_t>(i));
  }
  const auto sticks = static_cast<double>(middle.size());
  double sum = 0;
  int rows = 0;
  for (int k = 100; k < per_stick; ++k, ++rows) {
    double mean = 0, square = 0;
    for (const std::size_t s : middle) {
      const double value =
          static_cast<double>(samples[s * static_cast<std::size_t>(per_stick) + k]);
      mean += value / sticks;
      square += value * value / sticks;
    }
    sum += mean / std::sqrt(square - mean * mean);
  }
  return sum / rows;
}

/// Correlation of two Rayleigh envelopes whose IQ signals correlate by rho:
/// (F(-1/2, -1/2; 1; rho^2) - 1) / (4 / pi - 1).
double envelope_correlation(double rho) {
  double term = 1, series = 1;
  for (int n = 0; n < 60; ++n) {
    term *= (n - 0.5) * (n - 0.5) / ((n + 1.0) * (n + 1.0)) * rho * rho;
    series += term;
  }
  return (series - 1) / (4 / kPi - 1);
}

const double kRayleighSnr = std::sqrt(kPi / (4 - kPi));  // 1.913

TEST(Speckle, EnvelopeMeanOverSigmaIsRayleigh) {
  const hw::AcquisitionPlan plan({}, {});
  const auto samples = speckle_block(linear(), plan).volume(0);
  EXPECT_NEAR(speckle_snr(samples, plan), kRayleighSnr, 0.03);
}

TEST(Speckle, LowPassRaisesMeanOverSigmaAsPredicted) {
  const hw::AcquisitionPlan plan({}, {});
  ASSERT_EQ(iq_oversampling(plan), 2);
  auto options = linear();
  options.low_pass = true;
  const auto samples = speckle_block(options, plan).volume(0);
  // Noise filtered by a Gaussian pulse correlates over one IQ sample by exp(-(step / 2 sigma)^2).
  const double step = plan.sample_spacing_m() / 2 / sigma_of_fwhm(axial_fwhm_m(plan));
  const double rho = std::exp(-step * step / 4);
  const double expected = kRayleighSnr / std::sqrt((1 + envelope_correlation(rho)) / 2);
  EXPECT_NEAR(speckle_snr(samples, plan), expected, 0.03);
}

TEST(Speckle, AxialCorrelationFollowsThePulse) {
  hw::AcquisitionOptions acquisition;
  acquisition.samples_per_stick = 4096;
  const hw::AcquisitionPlan plan({}, acquisition);
  IqField field = make_iq_field(plan);
  const double sigma = sigma_of_fwhm(axial_fwhm_m(plan)) / field.spacing_m;
  const AxialKernels kernels(std::vector<double>(static_cast<std::size_t>(field.samples), sigma));
  std::vector<std::complex<double>> correlation(12);
  for (int line = 0; line < 64; ++line) {
    const auto stick = field.stick(0, line);
    fill_speckle(stick, static_cast<std::uint64_t>(line), kernels);
    for (std::size_t lag = 0; lag < correlation.size(); ++lag) {
      for (std::size_t i = 50; i + 50 < stick.size(); ++i) {
        correlation[lag] +=
            std::complex<double>(stick[i]) * std::conj(std::complex<double>(stick[i + lag]));
      }
    }
  }
  for (std::size_t lag = 1; lag < correlation.size(); ++lag) {
    const double n = static_cast<double>(lag);
    EXPECT_NEAR(correlation[lag].real() / correlation[0].real(),
                std::exp(-n * n / (4 * sigma * sigma)),
                0.03)
        << "lag " << lag;
  }
}

/// Correlation of the field along its sticks `lag` samples apart, within 4 mm of a range.
double axial_correlation(const IqField& field, double range_m, int lag) {
  const auto first = static_cast<int>((range_m - 4e-3) / field.spacing_m);
  const auto last = static_cast<int>((range_m + 4e-3) / field.spacing_m);
  std::complex<double> cross = 0;
  double power = 0;
  for (int stick = 0; stick < field.frames * field.lines; ++stick) {
    const auto values = field.stick(stick / field.lines, stick % field.lines);
    for (int i = first; i < last; ++i) {
      const std::complex<double> a = values[static_cast<std::size_t>(i)];
      cross += a * std::conj(std::complex<double>(values[static_cast<std::size_t>(i + lag)]));
      power += std::norm(a);
    }
  }
  return std::abs(cross) / power;
}

/// axial_mm of tests/yardstick/speckle.csv: full width at half maximum of the squared correlation,
/// taken as a Gaussian's. The pulse alone has 0.324 mm with the standard probe, 0.227 mm with
/// curvilinear-60.
TEST(Speckle, ItsLengthAtARangeIsThatOfTheElementSum) {
  struct Place {
    hw::ProbePreset preset;
    double range_m, fwhm_m;
  };
  for (const Place& place : {Place{hw::ProbePreset::standard, 40e-3, 0.2836e-3},
                             Place{hw::ProbePreset::standard, 150e-3, 0.32267e-3},
                             Place{hw::ProbePreset::c5_2v, 20e-3, 0.20655e-3},
                             Place{hw::ProbePreset::curvilinear_60, 60e-3, 0.22916e-3},
                             Place{hw::ProbePreset::curvilinear_60, 150e-3, 0.29284e-3}}) {
    const hw::ProbePresetData& data = hw::probe_preset(place.preset);
    hw::AcquisitionOptions acquisition;
    acquisition.sector_rad = data.sector_rad;
    acquisition.depth_m = 0.16;
    acquisition.samples_per_stick = 4096;
    acquisition.sticks_per_frame = 32;
    acquisition.frames_per_volume = 16;
    const IqField field = homogeneous_speckle(ProbeOptics({data.probe, acquisition}), 1);
    const double sigma_m = sigma_of_fwhm(place.fwhm_m);
    const auto lag = static_cast<int>(std::lround(0.5 * place.fwhm_m / field.spacing_m));
    const double lag_m = lag * field.spacing_m;
    EXPECT_NEAR(axial_correlation(field, place.range_m, lag),
                std::exp(-lag_m * lag_m / (4 * sigma_m * sigma_m)),
                0.025)
        << data.source << ", " << place.range_m << " m";
  }
}

IqField white_noise(const hw::AcquisitionPlan& plan) {
  IqField field = make_iq_field(plan);
  const AxialKernels white(std::vector<double>(static_cast<std::size_t>(field.samples), 0));
  for (int i = 0; i < field.frames * field.lines; ++i) {
    fill_speckle(
        field.stick(i / field.lines, i % field.lines), static_cast<std::uint64_t>(i), white);
  }
  return field;
}

/// Squared correlation of lines `lag` apart, the first of them from `first_line` up to `end_line`,
/// within 2.5 mm of a range.
double squared_line_correlation(
    const IqField& field, double range_m, int first_line, int end_line, int lag) {
  const auto first = static_cast<int>((range_m - 2.5e-3) / field.spacing_m);
  const auto last = static_cast<int>((range_m + 2.5e-3) / field.spacing_m);
  std::complex<double> cross = 0;
  double power_a = 0, power_b = 0;
  for (int f = 0; f < field.frames; ++f) {
    for (int line = first_line; line < end_line; ++line) {
      for (int i = first; i < last; ++i) {
        const std::complex<double> a = field.stick(f, line)[static_cast<std::size_t>(i)];
        const std::complex<double> b = field.stick(f, line + lag)[static_cast<std::size_t>(i)];
        cross += a * std::conj(b);
        power_a += std::norm(a);
        power_b += std::norm(b);
      }
    }
  }
  return std::norm(cross) / (power_a * power_b);
}

/// lateral_mm of tests/yardstick/speckle.csv, taken as a Gaussian's.
struct LateralWidth {
  double range_m, fwhm_m;
};

/// Of 1024 lines most are interpolated.
TEST(Speckle, DenseLinesCorrelateAsTheElementSumSays) {
  for (const int lines : {512, 1024}) {
    hw::AcquisitionOptions acquisition;
    acquisition.sticks_per_frame = lines;
    acquisition.frames_per_volume = 8;
    const hw::AcquisitionPlan plan({}, acquisition);
    IqField field = white_noise(plan);
    filter_across_lines(field, ProbeOptics(plan));
    for (const LateralWidth& place :
         {LateralWidth{75e-3, 1.6741e-3}, LateralWidth{150e-3, 2.2269e-3}}) {
      const double step_m = (plan.probe().radius_m + place.range_m) * plan.theta_step_rad();
      const double sigma_m = sigma_of_fwhm(place.fwhm_m);
      for (const int lag : {1, 2, 4, 6}) {
        const double steps = lag * step_m / (2 * sigma_m);
        // The middle, where no aperture is cut.
        EXPECT_NEAR(
            squared_line_correlation(field, place.range_m, 2 * lines / 5, 3 * lines / 5, lag),
            std::exp(-2 * steps * steps),
            0.05)
            << lines << " lines, " << place.range_m << " m, lag " << lag;
      }
    }
  }
}

TEST(Speckle, OnTheLastStickLinesCorrelateAsTheElementSumSays) {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 179;  // half a degree apart, 6 degrees past the array's end
  acquisition.sector_rad = 89 * kDegree;
  acquisition.frames_per_volume = 48;
  const hw::AcquisitionPlan plan({}, acquisition);
  IqField field = white_noise(plan);
  filter_across_lines(field, ProbeOptics(plan));
  for (const LateralWidth& place :
       {LateralWidth{20e-3, 4.7174e-3}, LateralWidth{30e-3, 3.7612e-3}}) {
    const double r = plan.probe().radius_m + place.range_m;
    const double width = place.fwhm_m / (r * plan.theta_step_rad());  // in lines
    const double last = (38.5 * kDegree - plan.theta_rad(0)) / plan.theta_step_rad();
    const auto lag = static_cast<int>(std::lround(0.5 * width));
    const int first_line = static_cast<int>(std::lround(last - 0.5 * lag));
    EXPECT_NEAR(squared_line_correlation(field, place.range_m, first_line, first_line + 1, lag),
                std::pow(0.5, std::pow(lag / (0.5 * width), 2)),
                0.07)
        << place.range_m;
  }
}

double mean_power(const IqField& field, int first_line, int line_step) {
  double power = 0;
  int sticks = 0;
  for (int f = 0; f < field.frames; ++f) {
    for (int line = first_line; line < field.lines; line += line_step, ++sticks) {
      for (const auto& value : field.stick(f, line)) power += static_cast<double>(std::norm(value));
    }
  }
  return power / (1.0 * sticks * field.samples);
}

TEST(Speckle, FiltersAcrossTheGridKeepThePower) {
  const hw::AcquisitionPlan plan({}, {});
  IqField field = make_iq_field(plan);
  const AxialKernels kernels(std::vector<double>(static_cast<std::size_t>(field.samples), 0.88));
  for (int i = 0; i < field.frames * field.lines; ++i) {
    fill_speckle(
        field.stick(i / field.lines, i % field.lines), static_cast<std::uint64_t>(i), kernels);
  }
  filter_across_lines(field, ProbeOptics(plan));
  filter_across_frames(field, ProbeOptics(plan));
  EXPECT_NEAR(mean_power(field, 0, 1), 1, 0.02);
}

TEST(Speckle, InterpolatedLinesKeepThePower) {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 1024;
  acquisition.frames_per_volume = 12;
  // Each second line lies halfway between two that are factored.
  acquisition.sector_rad = 1;
  const int factored =
      UniformLines::needed(ProbeOptics(hw::AcquisitionPlan({}, acquisition))).count;
  acquisition.sticks_per_frame = 2 * factored - 1;
  const hw::AcquisitionPlan plan({}, acquisition);
  ASSERT_EQ(UniformLines::needed(ProbeOptics(plan)).count, factored);
  IqField field = white_noise(plan);
  filter_across_lines(field, ProbeOptics(plan));
  EXPECT_NEAR(mean_power(field, 0, 2), 1, 0.01);
  EXPECT_NEAR(mean_power(field, 1, 2), 1, 0.01);
}

TEST(Speckle, AReflectorIsAPulseOfItsAmplitude) {
  hw::AcquisitionOptions acquisition;
  acquisition.samples_per_stick = 4096;
  const hw::AcquisitionPlan plan({}, acquisition);
  IqField field = make_iq_field(plan);
  const auto stick = field.stick(0, 0);
  const double range_m = 60e-3;
  add_reflector(stick, field.spacing_m, range_m, 0.5, plan);
  double area = 0;
  float peak = 0;
  for (const auto& value : stick) {
    area += static_cast<double>(std::abs(value)) * field.spacing_m;
    peak = std::max(peak, std::abs(value));
  }
  const double off = field.spacing_m / 2 / sigma_of_fwhm(axial_fwhm_m(plan));  // sampling, at worst
  EXPECT_LE(peak, 0.5f);
  EXPECT_GE(peak, 0.5 * std::exp(-0.5 * off * off) - 1e-6);
  // A Gaussian's area is peak * FWHM * sqrt(pi / (4 ln 2)).
  EXPECT_NEAR(area / 0.5, axial_fwhm_m(plan) * 1.0645, 1e-6);
}

TEST(Speckle, SticksBeyondTheArrayAreSilent) {
  hw::AcquisitionOptions acquisition;
  acquisition.sector_rad = 110 * kDegree;  // the array spans 77
  acquisition.sticks_per_frame = 45;
  acquisition.frames_per_volume = 3;
  const hw::AcquisitionPlan plan({}, acquisition);
  const int per_stick = acquisition.samples_per_stick, at_60mm = per_stick * 60 / 160;
  for (const Rung rung : {Rung::field, Rung::scatterers}) {
    auto options = linear();
    options.fidelity = rung;
    const auto samples = speckle_block(options, plan).volume(0);
    double outer = 0, middle = 0;
    for (int i = -40; i < 40; ++i) {
      outer = std::max(outer, static_cast<double>(samples[static_cast<std::size_t>(at_60mm + i)]));
      const int stick = 45 + 22;
      middle = std::max(
          middle,
          static_cast<double>(samples[static_cast<std::size_t>(stick * per_stick + at_60mm + i)]));
    }
    EXPECT_TRUE(std::all_of(
        samples.begin(), samples.end(), [](float s) { return std::isfinite(s) && s < 1e3f; }));
    EXPECT_LT(outer, 1e-3 * middle);
  }
}

}  // namespace
}  // namespace wobblebench::sim
