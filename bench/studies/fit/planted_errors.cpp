#include "bench/studies/fit/planted_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bench/evaluation/seed_statistics.h"

namespace wobblebench::bench {

namespace {

constexpr RegistrationParameter kPlanted[] = {kScale, kBias, kMotorAngle, kWobbleRadius};
/// The first reference seed less the scene's seed.
constexpr std::uint64_t kReferenceOffset = 100'000;
constexpr double kMostDepth_m = 0.4;
constexpr double kMostWobbleRadius_m = 0.2;  // as hw::ProbeOptions allow

/// The true value less the one that renderer and fit assume, by RegistrationParameter.
using PlantedErrors = std::array<double, kRegistrationParameters>;

/// The sign turns where the scene's probe would leave a range.
PlantedErrors plantable(const Scene& scene) {
  PlantedErrors errors{};
  errors[kScale] = 0.01;
  errors[kBias] = 0.5e-3;
  errors[kMotorAngle] = 1 * kDegree;
  errors[kWobbleRadius] = 1e-3;
  if (scene.probe.wobble_radius_m + errors[kWobbleRadius] > kMostWobbleRadius_m) {
    errors[kWobbleRadius] = -errors[kWobbleRadius];
  }
  if (scene.acquisition.depth_m * (1 + errors[kScale]) > kMostDepth_m) {
    errors[kScale] = -errors[kScale];
  }
  return errors;
}

/// The scene whose probe has the errors.
Scene with_errors(Scene scene, const PlantedErrors& errors) {
  scene.probe.wobble_radius_m += errors[kWobbleRadius];
  // Sound that is faster than the scanner assumes brings its samples from farther away.
  scene.acquisition.depth_m *= 1 + errors[kScale];
  return scene;
}

/// The subject as a motor sees it whose angle is `offset_rad` off: turned by the opposite angle
/// about the wobble axis.
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
        seen_by_motor(scene_.subject().value(), options.plan().geometry(), errors[kMotorAngle]));
    auto picture = render_frames(renderer_, scan_with_seed(truth, seed, phantom_.maps));
    for (float& z : picture.depth_m.pixels) z += static_cast<float>(errors[kBias]);
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

bool holds(const Registration& fit, RegistrationParameter parameter, double value) {
  return fit.low[parameter] <= value && value <= fit.high[parameter];
}

PlantedParameter summarise(RegistrationParameter parameter,
                           double planted,
                           const Coverage& coverage) {
  PlantedParameter result{.parameter = parameter, .planted = planted};
  const auto n = static_cast<double>(coverage.seeds.size());
  double squares = 0;
  for (const auto& [seed, fit] : coverage.seeds) {
    result.mean += fit.value[parameter] / n;
    result.half_width += 0.5 * (fit.high[parameter] - fit.low[parameter]) / n;
    result.covered += holds(fit, parameter, planted);
  }
  for (const auto& [seed, fit] : coverage.seeds) {
    squares += std::pow(fit.value[parameter] - result.mean, 2);
  }
  result.deviation = n > 1 ? std::sqrt(squares / (n - 1)) : 0;
  for (const auto& [seed, fit] : coverage.reference) {
    result.held_nothing += holds(fit, parameter, 0);
  }
  return result;
}

/// Distances of the pictures without planted errors.
class ReferenceDistances {
 public:
  void add(Image<float> distances_m) { all_.push_back(std::move(distances_m)); }

  /// Mean without the picture `left_out` (< 0: of all), where at least half of them have a
  /// distance.
  Image<float> mean(int left_out = -1) const {
    Image<float> result(all_.front().width, all_.front().height, kNoSurface);
    for (std::size_t i = 0; i < result.pixels.size(); ++i) {
      const auto values = at(i, left_out);
      if (2 * values.size() < all_.size() || values.empty()) continue;
      result.pixels[i] = static_cast<float>(mean_of(values));
    }
    return result;
  }

  /// Parts of the distances that repeat and that do not. The mean over seeds holds 1 / n of the
  /// random part's variance, which is subtracted.
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

Coverage measure_coverage(const Scene& scene,
                          const LoadedPhantom& phantom,
                          int seeds,
                          render::GlContext& context,
                          const PartDone& done) {
  PlantedScans scans(scene, phantom, context);
  PartCount parts(static_cast<std::size_t>(seeds) + kReferenceSeeds, done);
  Coverage coverage;
  const PlantedErrors none{}, planted = plantable(scene);
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
  for (const RegistrationParameter parameter : kPlanted) {
    coverage.parameters.push_back(summarise(parameter, planted[parameter], coverage));
  }
  return coverage;
}

}  // namespace wobblebench::bench
