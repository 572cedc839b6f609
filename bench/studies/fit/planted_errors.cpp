#include "bench/studies/fit/planted_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bench/studies/validate/seeds.h"

namespace wobblebench::bench {

namespace {

constexpr std::array<int, 4> kPlanted = {kScale, kBias, kMotorAngle, kWobbleRadius};
/// Reference seeds begin so far behind the scene's seed.
constexpr std::uint64_t kReferenceOffset = 100'000;

/// The scene whose probe has the errors.
Scene with_errors(Scene scene, const PlantedErrors& errors) {
  scene.probe.wobble_radius_m += errors.wobble_radius_m;
  // Sound that is faster than the scanner assumes brings its samples from farther away.
  scene.acquisition.depth_m *= 1 + errors.scale;
  return scene;
}

/// What a motor that stands off by an angle sees, seen by one that does not: the subject turned the
/// other way about the wobble axis.
phantoms::PlacedPhantom seen_by_motor(phantoms::PlacedPhantom subject,
                                      const hw::ProbeGeometry& probe,
                                      double offset_rad) {
  const glm::dvec3 axis(0, 0, probe.axis_z_m());
  const glm::dmat3 turn = phantoms::rotation_xyz({-offset_rad, 0, 0});
  subject.placement.rotation = turn * subject.placement.rotation;
  subject.placement.position_m = axis + turn * (subject.placement.position_m - axis);
  return subject;
}

class PlantedScans {
 public:
  PlantedScans(const Scene& scene, const LoadedPhantom& phantom, render::GlContext& context)
      : scene_(fit_scene(scene, phantom.phantom)),
        phantom_(phantom),
        renderer_(context, scene_.plan(), scene_.render()),
        registration_(scene_.subject().value(), scene_.plan(), scene_.view()) {}

  /// z, with the bias added.
  Image<float> depth(std::uint64_t seed, const PlantedErrors& errors) {
    const Scene options = with_errors(scene_.options(), errors);
    const ResolvedScene truth(
        options,
        seen_by_motor(scene_.subject().value(), options.plan().geometry(), errors.motor_angle_rad));
    auto picture = render_frames(renderer_, scan_with_seed(truth, seed, phantom_.maps));
    for (float& z : picture.depth_m.pixels) z += static_cast<float>(errors.bias_m);
    return picture.depth_m;
  }
  Image<float> distances(const Image<float>& depth_m) const {
    return registration_.distances(depth_m);
  }
  Registration difference(const Image<float>& depth_m, const Image<float>& expected_m) const {
    return registration_.fit_difference(depth_m, expected_m, RegistrationPriors::of_known_pose());
  }

 private:
  ResolvedScene scene_;
  LoadedPhantom phantom_;
  render::Renderer renderer_;
  SurfaceRegistration registration_;
};

struct MeanDeviation {
  double mean = 0;
  double deviation = 0;
};

MeanDeviation mean_deviation(const std::vector<PlantedSeed>& fits, int parameter) {
  const auto slot = static_cast<std::size_t>(parameter);
  const auto n = static_cast<double>(fits.size());
  MeanDeviation result;
  for (const auto& fit : fits) result.mean += fit.fit.value[slot] / n;
  double squares = 0;
  for (const auto& fit : fits) squares += std::pow(fit.fit.value[slot] - result.mean, 2);
  result.deviation = n > 1 ? std::sqrt(squares / (n - 1)) : 0;
  return result;
}

bool holds(const Registration& fit, int parameter, double value) {
  const auto slot = static_cast<std::size_t>(parameter);
  return fit.low[slot] <= value && value <= fit.high[slot];
}

PlantedParameter summarise(int parameter, const PlantedErrors& errors, const Coverage& coverage) {
  const auto slot = static_cast<std::size_t>(parameter);
  const auto found = mean_deviation(coverage.seeds, parameter);
  PlantedParameter result{parameter, errors.of(parameter), found.mean, found.deviation, 0, 0, 0};
  for (const auto& [seed, fit] : coverage.seeds) {
    result.half_width +=
        0.5 * (fit.high[slot] - fit.low[slot]) / static_cast<double>(coverage.seeds.size());
    result.covered += holds(fit, parameter, result.planted);
  }
  for (const auto& [seed, fit] : coverage.reference)
    result.held_nothing += holds(fit, parameter, 0);
  return result;
}

/// Pictures without planted errors: what of their distances repeats.
class ReferenceDistances {
 public:
  void add(Image<float> distances_m) { all_.push_back(std::move(distances_m)); }

  /// Of all but one, where at least half of them have a distance. `left_out` < 0: of all.
  Image<float> mean(int left_out = -1) const {
    Image<float> result(all_.front().width, all_.front().height, kNoSurface);
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
      const auto values = at(i, left_out);
      if (2 * values.size() < all_.size() || values.empty()) continue;
      result.pixels[i] = static_cast<float>(mean_of(values));
    }
    return result;
  }

  /// The variance of the mean over seeds is of both parts; that of what is random is taken off it.
  void split(Coverage& coverage) const {
    double repeatable = 0, random = 0, n = 0;
    for (std::size_t i = 0; i < all_.front().pixels.size(); ++i) {
      const auto values = at(i, -1);
      if (values.size() < all_.size() || values.size() < 2) continue;
      const double mean = mean_of(values), count = static_cast<double>(values.size());
      double variance = 0;
      for (const double value : values) variance += std::pow(value - mean, 2) / (count - 1);
      repeatable += mean * mean - variance / count;
      random += variance;
      ++n;
    }
    coverage.repeatable_rms_m = n > 0 ? std::sqrt(std::max(0.0, repeatable / n)) : 0;
    coverage.random_rms_m = n > 0 ? std::sqrt(random / n) : 0;
  }

 private:
  static double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  std::vector<double> at(std::size_t pixel, int left_out) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < all_.size(); ++k) {
      const float value = all_[k].pixels[pixel];
      if (static_cast<int>(k) == left_out || !std::isfinite(value)) continue;
      values.push_back(static_cast<double>(value));
    }
    return values;
  }

  std::vector<Image<float>> all_;
};

}  // namespace

double PlantedErrors::of(int parameter) const {
  switch (parameter) {
    case kScale:
      return scale;
    case kBias:
      return bias_m;
    case kMotorAngle:
      return motor_angle_rad;
    case kWobbleRadius:
      return wobble_radius_m;
    default:
      return 0;
  }
}

PlantedErrors plantable(const Scene& scene) {
  PlantedErrors errors;
  if (scene.probe.wobble_radius_m + errors.wobble_radius_m > scene.probe.radius_m) {
    errors.wobble_radius_m = -errors.wobble_radius_m;
  }
  constexpr double kMostDepth_m = 0.4;
  if (scene.acquisition.depth_m * (1 + errors.scale) > kMostDepth_m) errors.scale = -errors.scale;
  return errors;
}

Coverage measure_coverage(const Scene& scene,
                          const LoadedPhantom& phantom,
                          int seeds,
                          render::GlContext& context,
                          const PartDone& done) {
  PlantedScans scans(scene, phantom, context);
  PartCount parts(static_cast<std::size_t>(seeds) + kReferenceSeeds, done);
  Coverage coverage;
  const PlantedErrors none{0, 0, 0, 0}, planted = plantable(scene);
  const std::uint64_t first = scene.simulation.seed;
  ReferenceDistances reference;
  std::vector<Image<float>> unplanted;
  for (const std::uint64_t seed : seeds_from(first + kReferenceOffset, kReferenceSeeds)) {
    unplanted.push_back(scans.depth(seed, none));
    reference.add(scans.distances(unplanted.back()));
    coverage.reference.push_back({seed, {}});
    parts.finish_one();
  }
  for (std::size_t i = 0; i < unplanted.size(); ++i) {
    coverage.reference[i].fit = scans.difference(unplanted[i], reference.mean(static_cast<int>(i)));
  }
  reference.split(coverage);
  const Image<float> expected_m = reference.mean();
  for (const std::uint64_t seed : seeds_from(first, seeds)) {
    coverage.seeds.push_back({seed, scans.difference(scans.depth(seed, planted), expected_m)});
    parts.finish_one();
  }
  for (const int parameter : kPlanted) {
    coverage.parameters.push_back(summarise(parameter, planted, coverage));
  }
  return coverage;
}

}  // namespace wobblebench::bench
