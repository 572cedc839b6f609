#include "bench/studies/fit/planted_errors.h"

#include <array>
#include <cmath>

#include "bench/studies/validate/seeds.h"

namespace wobblebench::bench {

namespace {

constexpr std::array<int, 4> kPlanted = {kScale, kBias, kMotorAngle, kWobbleRadius};
/// Two-sided 95 % quantile of Student's t with kReferenceSeeds - 1 degrees of freedom.
constexpr double kStudent = 2.262;
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
        subject_(scene_.place(phantom.phantom)),
        renderer_(context, scene_.plan(), scene_.render),
        registration_(subject_, scene_.plan(), render::make_view(scene_.render)) {}

  PlantedSeed fit(std::uint64_t seed, const PlantedErrors& errors) {
    const Scene truth = with_errors(scene_, errors);
    const auto subject = seen_by_motor(subject_, truth.plan().geometry(), errors.motor_angle_rad);
    auto picture = render_frames(renderer_, scan_with_seed(truth, seed, subject, phantom_.maps));
    for (float& z : picture.depth_m.pixels) z += static_cast<float>(errors.bias_m);
    return {seed, registration_.fit(picture.depth_m, RegistrationPriors::of_known_pose())};
  }

 private:
  Scene scene_;
  LoadedPhantom phantom_;
  phantoms::PlacedPhantom subject_;
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

PlantedParameter summarise(int parameter, const PlantedErrors& errors, const Coverage& coverage) {
  const auto slot = static_cast<std::size_t>(parameter);
  const auto reference = mean_deviation(coverage.reference, parameter);
  const auto found = mean_deviation(coverage.seeds, parameter);
  const double reference_width =
      kStudent * reference.deviation / std::sqrt(static_cast<double>(coverage.reference.size()));
  PlantedParameter result{parameter,
                          errors.of(parameter),
                          found.mean - reference.mean,
                          found.deviation,
                          0,
                          reference.mean,
                          0};
  for (const auto& [seed, fit] : coverage.seeds) {
    const double value = fit.value[slot] - reference.mean;
    const double low = value - std::hypot(fit.value[slot] - fit.low[slot], reference_width);
    const double high = value + std::hypot(fit.high[slot] - fit.value[slot], reference_width);
    result.half_width += 0.5 * (high - low) / static_cast<double>(coverage.seeds.size());
    result.covered += low <= result.planted && result.planted <= high;
  }
  return result;
}

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
  for (const std::uint64_t seed : seeds_from(first + kReferenceOffset, kReferenceSeeds)) {
    coverage.reference.push_back(scans.fit(seed, none));
    parts.finish_one();
  }
  for (const std::uint64_t seed : seeds_from(first, seeds)) {
    coverage.seeds.push_back(scans.fit(seed, planted));
    parts.finish_one();
  }
  for (const int parameter : kPlanted) {
    coverage.parameters.push_back(summarise(parameter, planted, coverage));
  }
  return coverage;
}

}  // namespace wobblebench::bench
