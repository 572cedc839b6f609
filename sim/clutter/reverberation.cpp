#include "sim/clutter/reverberation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "sim/losses/losses.h"
#include "sim/math/fast_math.h"

namespace wobblebench::sim {

namespace {

/// Images below this are left out: -80 dB of echoes that are themselves below full scale.
constexpr double kLeastImage = 1e-4;
/// Nearer layers ring within the pulse's own length.
constexpr double kNearest_m = 1e-3;
/// Standard deviation of the tilt at which a layer still sends sound back to the stick's aperture.
/// Assumed: between the specular lobe of a focused beam and the angle that an array as a whole
/// takes in.
constexpr double kTilt_rad = 8 * kDegree;

/// target[i] += sum over k of weights[k] source[i + 3 - k], for `count` samples that do not depend
/// on each other.
WOBBLEBENCH_SIMD void add_image(float* __restrict target,
                                const float* __restrict source,
                                int count,
                                const std::complex<float>* weights) {
  for (int k = 0; k < 4; ++k) {
    const float a = weights[k].real(), b = weights[k].imag();
    const float* from = source + 2 * static_cast<std::ptrdiff_t>(3 - k);
    for (int i = 0; i < count; ++i) {
      const std::ptrdiff_t at = 2 * static_cast<std::ptrdiff_t>(i);
      target[at] += a * from[at] - b * from[at + 1];
      target[at + 1] += a * from[at + 1] + b * from[at];
    }
  }
}

/// Lagrange's cubic at `share` of the way from the second to the third of four samples.
std::array<double, 4> cubic_weights(double share) {
  const double t = share;
  return {-t * (t - 1) * (t - 2) / 6,
          (t + 1) * (t - 1) * (t - 2) / 2,
          -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

}  // namespace

Reverberation::Reverberation(const hw::AcquisitionPlan& plan,
                             const SimulationOptions& options,
                             const std::vector<phantoms::Material>& materials,
                             double spacing_m)
    : face_(options.clutter.probe_reflection),
      cycles_per_m_(2 * plan.probe().center_frequency_hz / plan.acquisition().sound_speed_m_s),
      spacing_m_(spacing_m),
      materials_(&materials) {}

void Reverberation::find_images(const StickTrack& track, const StickLosses& losses) {
  images_.clear();
  for (std::size_t i = 0; i < track.interfaces.size(); ++i) {
    const Interface& at = track.interfaces[i];
    const double tilt = std::acos(std::clamp(at.cos_incidence, 0.0, 1.0)) / kTilt_rad;
    const double echo =
        losses.at_interface()[i] * reflection(materials_->at(static_cast<std::size_t>(at.before)),
                                              materials_->at(static_cast<std::size_t>(at.behind)),
                                              at.cos_incidence);
    const double image = face_ * echo * std::exp(-0.5 * tilt * tilt);
    const double range_m = losses.apparent_m(track, at.range_m);
    const auto whole = static_cast<int>(range_m / spacing_m_);
    if (std::abs(image) < kLeastImage || range_m < kNearest_m || whole < 2) continue;
    const double cycles = range_m * cycles_per_m_;
    const std::complex<double> turned = std::polar(image, -2 * kPi * (cycles - std::floor(cycles)));
    const auto weights = cubic_weights(range_m / spacing_m_ - whole);
    Image& added = images_.emplace_back();
    added.delay = whole - 1;
    std::ranges::transform(weights, added.weights.begin(), [&](double weight) {
      return std::complex<float>(weight * turned);
    });
  }
}

void Reverberation::add(const StickTrack& track,
                        const StickLosses& losses,
                        std::span<std::complex<float>> iq) {
  if (face_ == 0) return;
  find_images(track, losses);
  if (images_.empty()) return;
  const auto nearest = std::ranges::min_element(images_, {}, &Image::delay);
  const int count = static_cast<int>(iq.size()), each = nearest->delay;
  // Each block reads only samples that are complete, so that images of images are in them.
  for (int first = each; first < count; first += each) {
    const int block = std::min(each, count - first);
    for (const Image& image : images_) {
      const int from = first - image.delay - 3, skip = std::max(0, -from);
      if (skip >= block) continue;
      add_image(parts_of(iq.data() + first + skip),
                parts_of(iq.data() + from + skip),
                block - skip,
                image.weights.data());
    }
  }
}

}  // namespace wobblebench::sim
