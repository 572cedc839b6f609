#include "bench/studies/rungs/rung_comparison.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/statistics.h"
#include "base/units.h"
#include "phantoms/truth.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

namespace {

/// Displayed value of the mean of three samples from which on it is a surface.
constexpr double kSurfaceLevel = 0.3;
const double kNone = std::numeric_limits<double>::quiet_NaN();

/// A stick in the phantom frame, and the range where the search for a surface begins.
struct Search {
  hw::Ray ray;
  double from_m;
};

Search search_along(const RungScene& scene, int stick) {
  const auto index = scene.plan.index(static_cast<std::uint64_t>(stick));
  const auto ray = scene.plan.geometry().stick(scene.plan.theta_rad(static_cast<int>(index.line)),
                                               scene.plan.motor_angle_rad(index));
  const hw::Ray here{scene.subject.placement.to_phantom(ray.origin),
                     scene.subject.placement.direction_to_phantom(ray.direction)};
  const double front_z = scene.subject.phantom.region_of_interest().low.z;
  return {here, std::max(0.0, (front_z - here.origin.z) / here.direction.z)};
}

/// The displayed volume of a scene on one rung.
struct RungImage {
  sim::Rung rung;
  std::vector<double> surface_m;  ///< range on each stick; NaN: none
  std::vector<double> mean;       ///< of each sample, over the seeds
};

double detected_range_m(const hw::AcquisitionPlan& plan, const float* stick, double from_m) {
  const int samples = plan.acquisition().samples_per_stick;
  const auto mean = [&](int k) {
    return (static_cast<double>(stick[k - 1]) + static_cast<double>(stick[k]) +
            static_cast<double>(stick[k + 1])) /
           3;
  };
  const int first = std::max(1, static_cast<int>(from_m / plan.sample_spacing_m()) + 1);
  for (int k = first + 1; k + 1 < samples; ++k) {
    const double before = mean(k - 1), here = mean(k);
    if (before >= kSurfaceLevel) return kNone;  // starts in tissue
    if (here < kSurfaceLevel) continue;
    const double fraction = (kSurfaceLevel - before) / (here - before);
    return plan.sample_range_m(k - 1) + fraction * plan.sample_spacing_m();
  }
  return kNone;
}

RungImage scan_rung(const RungScene& scene,
                    sim::Rung rung,
                    const std::vector<std::uint64_t>& seeds) {
  RungImage image{rung, {}, {}};
  // Nothing in geometry is random.
  const std::size_t count = rung == sim::Rung::geometry ? 1 : seeds.size();
  for (std::size_t s = 0; s < count; ++s) {
    auto options = scene.options;
    options.fidelity = rung;
    options.seed = seeds[s];
    const auto volume = sim::ProbeSimulator(scene.subject, scene.plan, options).volume(0);
    image.mean.resize(volume.size(), 0.0);
    for (std::size_t i = 0; i < volume.size(); ++i) {
      image.mean[i] += static_cast<double>(volume[i]) / static_cast<double>(count);
    }
    if (s > 0) continue;
    const auto samples = static_cast<std::size_t>(scene.plan.acquisition().samples_per_stick);
    for (int stick = 0; stick < scene.plan.sticks_per_volume(); ++stick) {
      image.surface_m.push_back(
          detected_range_m(scene.plan,
                           volume.data() + static_cast<std::size_t>(stick) * samples,
                           search_along(scene, stick).from_m));
    }
  }
  return image;
}

RangeError range_error(const std::vector<double>& detected, const std::vector<double>& expected) {
  std::vector<double> signed_mm, abs_mm;
  long missed = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (std::isnan(expected[i])) continue;
    if (std::isnan(detected[i])) {
      ++missed;
      continue;
    }
    signed_mm.push_back((detected[i] - expected[i]) / kMillimetre);
    abs_mm.push_back(std::abs(signed_mm.back()));
  }
  RangeError result;
  result.n = static_cast<long>(abs_mm.size());
  const double sticks = static_cast<double>(missed + result.n);
  if (sticks > 0) result.missed_percent = 100.0 * static_cast<double>(missed) / sticks;
  if (abs_mm.empty()) return result;
  result.median_mm = spread_of(signed_mm).median;
  result.median_abs_mm = spread_of(abs_mm).median;
  result.p95_abs_mm = quantile(abs_mm, 0.95);
  return result;
}

/// The samples that are above zero in one of two images.
struct ImagePair {
  std::vector<double> a, b;

  ImagePair(const RungImage& one, const RungImage& other) {
    for (std::size_t i = 0; i < one.mean.size(); ++i) {
      if (one.mean[i] <= 0 && other.mean[i] <= 0) continue;
      a.push_back(one.mean[i]);
      b.push_back(other.mean[i]);
    }
  }
  double rms() const {
    std::vector<double> differences(a.size());
    std::transform(a.begin(), a.end(), b.begin(), differences.begin(), std::minus<>());
    return root_mean_square(differences);
  }
};

}  // namespace

std::vector<double> true_ranges(const RungScene& scene) {
  const phantoms::SurfaceFinder finder(scene.subject.phantom);
  std::vector<double> ranges;
  for (int stick = 0; stick < scene.plan.sticks_per_volume(); ++stick) {
    const Search at = search_along(scene, stick);
    const auto hit = finder.first_hit(
        at.ray.origin, at.ray.direction, at.from_m, scene.plan.acquisition().depth_m);
    ranges.push_back(hit ? hit->distance_m : kNone);
  }
  return ranges;
}

std::vector<RungError> measure_rung_errors(const std::string& body,
                                           const RungScene& scene,
                                           const std::vector<sim::Rung>& rungs,
                                           const std::vector<std::uint64_t>& seeds) {
  const auto truth = true_ranges(scene);
  std::vector<RungImage> images;
  for (const sim::Rung rung : rungs) images.push_back(scan_rung(scene, rung, seeds));
  std::vector<RungError> errors;
  for (std::size_t i = 0; i < images.size(); ++i) {
    RungError error{body, images[i].rung, range_error(images[i].surface_m, truth), {}, {}, {}};
    if (i + 1 < images.size()) {
      const ImagePair pair(images[i], images[i + 1]);
      error.against_above = range_error(images[i].surface_m, images[i + 1].surface_m);
      error.image_rms_db = pair.rms() * scene.options.dynamic_range_db;
      error.image_correlation = correlation(pair.a, pair.b);
    }
    errors.push_back(std::move(error));
  }
  return errors;
}

}  // namespace wobblebench::bench
