#include "sim/clutter/uneven_tissue.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "sim/math/fast_math.h"
#include "sim/math/random.h"
#include "sim/math/smooth_noise.h"

namespace wobblebench::sim {

namespace {

/// Multiplies by a factor that is linear in the sample.
WOBBLEBENCH_SIMD void scale(float* parts, int count, float first, float step) {
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
    const float factor = first + step * static_cast<float>(i);
    parts[at] *= factor;
    parts[at + 1] *= factor;
  }
}

}  // namespace

UnevenTissue::UnevenTissue(const ScannedTissue& tissue,
                           const SimulationOptions& options,
                           double spacing_m)
    : tissue_(&tissue),
      sigma_db_(options.clutter.tissue_unevenness_db),
      grain_m_(options.clutter.tissue_grain_m),
      skin_m_(options.clutter.even_skin_m),
      spacing_m_(spacing_m),
      key_(random_key(options.seed, RandomStream::uneven_tissue, 0)) {}

std::vector<UnevenTissue::Fluid> UnevenTissue::fluids(const StickTrack& track,
                                                      const StickLosses& losses) const {
  std::vector<Fluid> found;
  if (skin_m_ == 0) return found;
  for (const Stretch& stretch : track.stretches) {
    const auto material = static_cast<std::size_t>(stretch.material);
    if (tissue_->materials[material].backscatter_db > kZeroAmplitude_db) continue;
    found.push_back(
        {losses.apparent_m(track, stretch.from_m), losses.apparent_m(track, stretch.to_m)});
  }
  return found;
}

double UnevenTissue::sigma_db(std::span<const Fluid> fluids, double range_m) const {
  const auto behind =
      std::ranges::find_if(fluids, [&](const Fluid& fluid) { return fluid.from_m > range_m; });
  if (behind == fluids.begin()) return sigma_db_;
  const double depth_m = range_m - std::prev(behind)->to_m;
  return sigma_db_ * std::clamp(depth_m / skin_m_, 0.0, 1.0);
}

void UnevenTissue::apply(const TimedRay& line,
                         const StickTrack& track,
                         const StickLosses& losses,
                         std::span<std::complex<float>> iq) const {
  if (sigma_db_ == 0) return;
  const StickTransform transform(*tissue_, line);
  const std::vector<Fluid> before = fluids(track, losses);
  const int count = static_cast<int>(iq.size());
  const double step_m = 0.5 * (skin_m_ > 0 ? std::min(grain_m_, skin_m_) : grain_m_);
  const int each = std::max(1, static_cast<int>(step_m / spacing_m_));
  const auto factor = [&](int sample) {
    const double range_m = (sample + 0.5) * spacing_m_;
    const double sigma = sigma_db(before, range_m);
    if (sigma == 0) return 1.0f;
    const glm::dvec3 rest_m = transform.to_rest({range_m, 0, 0});
    return level_factor(sigma, smooth_noise(key_, rest_m / grain_m_));
  };
  float near = factor(0);
  for (int first = 0; first < count; first += each) {
    const float far = factor(first + each);
    scale(parts_of(iq.data() + first),
          std::min(each, count - first),
          near,
          (far - near) / static_cast<float>(each));
    near = far;
  }
}

}  // namespace wobblebench::sim
