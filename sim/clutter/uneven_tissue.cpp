#include "sim/clutter/uneven_tissue.h"

#include <algorithm>
#include <cstddef>

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
      spacing_m_(spacing_m),
      key_(random_key(options.seed, RandomStream::uneven_tissue, 0)) {}

void UnevenTissue::apply(const TimedRay& line, std::span<std::complex<float>> iq) const {
  if (sigma_db_ == 0) return;
  const StickTransform transform(*tissue_, line);
  const int count = static_cast<int>(iq.size());
  const int each = std::max(1, static_cast<int>(0.5 * grain_m_ / spacing_m_));
  const auto factor = [&](int sample) {
    const glm::dvec3 rest_m = transform.to_rest({(sample + 0.5) * spacing_m_, 0, 0});
    return level_factor(sigma_db_, smooth_noise(key_, rest_m / grain_m_));
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
