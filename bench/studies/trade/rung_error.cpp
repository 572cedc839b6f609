#include "bench/studies/trade/rung_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/statistics.h"
#include "base/units.h"
#include "bench/studies/validate/statistics.h"
#include "phantoms/truth.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

namespace {

/// Of the mean of three samples, as displayed.
constexpr double kSurfaceLevel = 0.3;
const double kNone = std::numeric_limits<double>::quiet_NaN();

/// A stick in the phantom's frame, and where its search for a surface begins.
struct Search {
  hw::Ray ray;
  double from_m;
};

Search search(const TradeScene& scene, int place) {
  const auto index = scene.plan.index(static_cast<std::uint64_t>(place));
  const auto ray = scene.plan.geometry().stick(scene.plan.theta_rad(static_cast<int>(index.line)),
                                               scene.plan.motor_angle_rad(index));
  const hw::Ray here{scene.subject.placement.to_phantom(ray.origin),
                     scene.subject.placement.direction_to_phantom(ray.direction)};
  const double front_z = scene.subject.phantom.region_of_interest().low.z;
  return {here, std::max(0.0, (front_z - here.origin.z) / here.direction.z)};
}

/// What one rung shows of a scene.
struct Shown {
  sim::Rung rung;
  std::vector<double> surface_m;  ///< of each stick
  std::vector<double> mean;       ///< of each sample
};

double found_m(const hw::AcquisitionPlan& plan, const float* stick, double from_m) {
  const int samples = plan.acquisition().samples_per_stick;
  const auto mean = [&](int k) {
    return (static_cast<double>(stick[k - 1]) + static_cast<double>(stick[k]) +
            static_cast<double>(stick[k + 1])) /
           3;
  };
  const int first = std::max(1, static_cast<int>(from_m / plan.sample_spacing_m()) + 1);
  for (int k = first + 1; k + 1 < samples; ++k) {
    const double before = mean(k - 1), here = mean(k);
    if (before >= kSurfaceLevel) return kNone;  // it began in tissue
    if (here < kSurfaceLevel) continue;
    const double share = (kSurfaceLevel - before) / (here - before);
    return plan.sample_range_m(k - 1) + share * plan.sample_spacing_m();
  }
  return kNone;
}

Shown show(const TradeScene& scene, sim::Rung rung, const std::vector<std::uint64_t>& seeds) {
  Shown shown{rung, {}, {}};
  // Nothing in geometry is random.
  const std::size_t count = rung == sim::Rung::geometry ? 1 : seeds.size();
  for (std::size_t s = 0; s < count; ++s) {
    auto options = scene.options;
    options.fidelity = rung;
    options.seed = seeds[s];
    const auto volume = sim::ProbeSimulator(scene.subject, scene.plan, options).volume(0);
    shown.mean.resize(volume.size(), 0.0);
    for (std::size_t i = 0; i < volume.size(); ++i) {
      shown.mean[i] += static_cast<double>(volume[i]) / static_cast<double>(count);
    }
    if (s > 0) continue;
    const auto samples = static_cast<std::size_t>(scene.plan.acquisition().samples_per_stick);
    for (int place = 0; place < scene.plan.sticks_per_volume(); ++place) {
      shown.surface_m.push_back(found_m(scene.plan,
                                        volume.data() + static_cast<std::size_t>(place) * samples,
                                        search(scene, place).from_m));
    }
  }
  return shown;
}

DepthSpread spread(const std::vector<double>& found, const std::vector<double>& wanted) {
  std::vector<double> signed_mm, size_mm;
  long missed = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (std::isnan(wanted[i])) continue;
    if (std::isnan(found[i])) {
      ++missed;
      continue;
    }
    signed_mm.push_back((found[i] - wanted[i]) / kMillimetre);
    size_mm.push_back(std::abs(signed_mm.back()));
  }
  DepthSpread result;
  result.n = static_cast<long>(size_mm.size());
  if (size_mm.empty()) return result;
  result.median_mm = spread_of(signed_mm).median;
  result.median_size_mm = spread_of(size_mm).median;
  result.p95_size_mm = quantile_lower(size_mm, 0.95);
  result.missed_percent =
      100.0 * static_cast<double>(missed) / static_cast<double>(missed + result.n);
  return result;
}

/// Samples that one of the two images shows.
struct BothImages {
  std::vector<double> a, b;

  BothImages(const Shown& one, const Shown& other) {
    for (std::size_t i = 0; i < one.mean.size(); ++i) {
      if (one.mean[i] <= 0 && other.mean[i] <= 0) continue;
      a.push_back(one.mean[i]);
      b.push_back(other.mean[i]);
    }
  }
  double rms() const {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum / static_cast<double>(a.size()));
  }
};

}  // namespace

std::vector<double> true_ranges(const TradeScene& scene) {
  const phantoms::SurfaceFinder finder(scene.subject.phantom);
  std::vector<double> ranges;
  for (int place = 0; place < scene.plan.sticks_per_volume(); ++place) {
    const Search at = search(scene, place);
    const auto hit = finder.first_hit(
        at.ray.origin, at.ray.direction, at.from_m, scene.plan.acquisition().depth_m);
    ranges.push_back(hit ? hit->distance_m : kNone);
  }
  return ranges;
}

std::vector<RungError> measure_rung_errors(const std::string& body,
                                           const TradeScene& scene,
                                           const std::vector<sim::Rung>& rungs,
                                           const std::vector<std::uint64_t>& seeds) {
  const auto truth = true_ranges(scene);
  std::vector<Shown> shown;
  for (const sim::Rung rung : rungs) shown.push_back(show(scene, rung, seeds));
  std::vector<RungError> errors;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    RungError error{body, shown[i].rung, spread(shown[i].surface_m, truth), {}, {}, {}};
    if (i + 1 < shown.size()) {
      const BothImages images(shown[i], shown[i + 1]);
      error.against_above = spread(shown[i].surface_m, shown[i + 1].surface_m);
      error.image_rms_db = images.rms() * scene.options.dynamic_range_db;
      error.image_correlation = correlation(images.a, images.b);
    }
    errors.push_back(std::move(error));
  }
  return errors;
}

}  // namespace wobblebench::bench
