#include "bench/studies/validate/speckle_size.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/statistics.h"
#include "sim/beam/beam_profile.h"
#include "sim/beam/point_spread.h"

namespace wobblebench::bench {

namespace {

constexpr double kDepth_m = 0.12;
constexpr int kFineSamples = 4096;
constexpr int kSamples = 480;
/// Largest lag, in expected widths.
constexpr double kLagFwhm = 1.5;
/// Dense sectors and fans: steps of about a third of the width at the evaluated ranges.
constexpr double kDenseSector_rad = 32 * kDegree;
constexpr double kDenseFan_rad = 61 * kDegree;
constexpr double kSparseSector_rad = 30 * kDegree;

hw::AcquisitionOptions plan_for(BeamDirection direction, const SpeckleSizeInputs& inputs) {
  hw::AcquisitionOptions acquisition{.depth_m = kDepth_m, .samples_per_stick = kSamples};
  acquisition.sticks_per_frame = inputs.sparse;
  acquisition.frames_per_volume = inputs.sparse;
  switch (direction) {
    case BeamDirection::axial:
      acquisition.samples_per_stick = kFineSamples;
      break;
    case BeamDirection::lateral:
      acquisition.sector_rad = kDenseSector_rad;
      acquisition.sticks_per_frame = inputs.dense;
      break;
    case BeamDirection::elevation:
      acquisition.sector_rad = kSparseSector_rad;
      acquisition.fan_rad = kDenseFan_rad;
      acquisition.frames_per_volume = inputs.dense;
      break;
  }
  return acquisition;
}

/// Spacing in the dense direction; across frames the mean over the lines.
double step_m(BeamDirection direction, const hw::AcquisitionPlan& plan, double range_m) {
  if (direction == BeamDirection::axial) return plan.sample_spacing_m();
  if (direction == BeamDirection::lateral) {
    return (plan.probe().radius_m + range_m) * plan.theta_step_rad();
  }
  double sum = 0;
  const int lines = plan.acquisition().sticks_per_frame;
  for (int line = 0; line < lines; ++line) sum += sim::frame_distance_m(plan, line, range_m);
  return sum / lines;
}

double point_spread_m(BeamDirection direction, const hw::AcquisitionPlan& plan, double range_m) {
  switch (direction) {
    case BeamDirection::axial:
      return sim::axial_fwhm_m(plan);
    case BeamDirection::lateral:
      return sim::BeamProfile(plan, {}).lateral_fwhm_m(range_m);
    case BeamDirection::elevation:
      return sim::BeamProfile(plan, {}).elevation_fwhm_m(range_m);
  }
  throw std::logic_error("BeamDirection: no such direction");
}

/// Intensities of neighbours, `lag` steps apart in the dense direction.
struct Pairs {
  BeamDirection direction;
  int first;  ///< sample
  int last;

  template <class Body>
  void for_each(const Scan& volume, int lag, const Body& body) const {
    const auto& a = volume.plan.acquisition();
    const int df = direction == BeamDirection::elevation ? lag : 0;
    const int dl = direction == BeamDirection::lateral ? lag : 0;
    const int dk = direction == BeamDirection::axial ? lag : 0;
    for (int f = 0; f + df < a.frames_per_volume; ++f) {
      for (int l = 0; l + dl < a.sticks_per_frame; ++l) {
        for (int k = first; k + dk < last; ++k) {
          const double x = volume.at(f, l, k), y = volume.at(f + df, l + dl, k + dk);
          body(x * x, y * y);
        }
      }
    }
  }
};

/// Lag at which the value is one half, interpolated as a Gaussian between lags.
double half_width(const std::vector<double>& lag_m, const std::vector<double>& value) {
  for (std::size_t i = 1; i < value.size(); ++i) {
    if (value[i] > 0.5) continue;
    const double before = -std::log(value[i - 1]);
    const double behind = -std::log(std::max(value[i], 1e-3));
    const double fraction = (std::log(2.0) - before) / (behind - before);
    const double low2 = lag_m[i - 1] * lag_m[i - 1], high2 = lag_m[i] * lag_m[i];
    return std::sqrt(low2 + fraction * (high2 - low2));
  }
  throw std::runtime_error("speckle size: the autocorrelation does not fall to half");
}

}  // namespace

double expected_speckle_m(sim::Rung,
                          BeamDirection direction,
                          const hw::AcquisitionPlan& plan,
                          double range_m) {
  return point_spread_m(direction, plan, range_m);
}

std::vector<Autocorrelation> measure_speckle_size(sim::Rung rung,
                                                  BeamDirection direction,
                                                  const SpeckleSizeInputs& inputs) {
  const hw::AcquisitionPlan plan({}, plan_for(direction, inputs));
  const auto tissue = open_tissue();
  std::vector<Scan> volumes;
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = lossless_envelope(rung, seed);
    options.side_lobes = inputs.side_lobes && rung == sim::Rung::scatterers;
    volumes.push_back(scan({tissue}, plan, options));
  }
  std::vector<Autocorrelation> results;
  for (const double range_m : inputs.ranges_m) {
    const Pairs pairs{direction,
                      volumes.front().sample_at(range_m - inputs.half_window_m),
                      volumes.front().sample_at(range_m + inputs.half_window_m)};
    Moments intensity;
    for (const Scan& volume : volumes) {
      pairs.for_each(volume, 0, [&](double x, double) { intensity.add(x); });
    }
    const double mean = intensity.mean();
    Autocorrelation result;
    result.range_m = range_m;
    // Mean over the window: near the foci the width varies within it.
    for (const double fraction : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
      result.expected_m +=
          0.2 *
          expected_speckle_m(rung, direction, plan, range_m + fraction * inputs.half_window_m);
    }
    const double step = step_m(direction, plan, range_m);
    for (int lag = 0; lag * step < kLagFwhm * result.expected_m || lag < 4; ++lag) {
      double sum = 0, count = 0;
      for (const Scan& volume : volumes) {
        pairs.for_each(volume, lag, [&](double x, double y) {
          sum += (x - mean) * (y - mean);
          ++count;
        });
      }
      result.lag_m.push_back(lag * step);
      result.value.push_back(sum / count / (intensity.sigma() * intensity.sigma()));
    }
    result.fwhm_m = 2 * half_width(result.lag_m, result.value);
    const double axial_cells = 2 * inputs.half_window_m / sim::axial_fwhm_m(plan);
    const double across_cells =
        direction == BeamDirection::axial ? inputs.sparse : inputs.dense * step / result.expected_m;
    result.cells = static_cast<long>(axial_cells * across_cells * inputs.sparse *
                                     static_cast<double>(inputs.seeds.size()));
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace wobblebench::bench
