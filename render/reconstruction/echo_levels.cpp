#include "render/reconstruction/echo_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"
#include "render/camera.h"

namespace wobblebench::render {
namespace {

constexpr int kBins = 256;

/// Of means over kLevelMean_m, and the number of single samples that are white.
struct Histogram {
  std::array<std::uint64_t, kBins> counts{};
  std::uint64_t white = 0;
};

double center(int bin) {
  return (bin + 0.5) / kBins;
}

Histogram histogram(const hw::AcquisitionPlan& plan,
                    const std::vector<std::vector<float>>& frames,
                    const std::vector<SampleSpan>& spans) {
  const int lines = plan.acquisition().sticks_per_frame;
  const int samples = plan.acquisition().samples_per_stick;
  const int window = samples_in(kLevelMean_m, plan);
  std::vector<Histogram> of_frame(frames.size(), Histogram{});
  parallel_rows(static_cast<int>(frames.size()), [&](int frame) {
    Histogram& sum = of_frame[static_cast<std::size_t>(frame)];
    for (int line = 0; line < lines; ++line) {
      const SampleSpan span = spans[static_cast<std::size_t>(frame * lines + line)];
      if (span.begin >= span.end) continue;
      const float* stick =
          frames[static_cast<std::size_t>(frame)].data() + std::ptrdiff_t{line} * samples;
      const WindowMeans means(stick, samples);
      for (int k = span.begin; k < span.end; ++k) {
        sum.white += stick[k] >= kWhite;
        const int bin =
            static_cast<int>(means.mean(k - window / 2, k - window / 2 + window) * kBins);
        ++sum.counts[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
      }
    }
  });
  Histogram total{};
  for (const Histogram& sum : of_frame) {
    total.white += sum.white;
    for (std::size_t bin = 0; bin < kBins; ++bin) total.counts[bin] += sum.counts[bin];
  }
  return total;
}

/// Number, sum and sum of squares of the values of some bins.
struct Sums {
  double n = 0, x = 0, xx = 0;

  void add(int bin, std::uint64_t count) {
    n += static_cast<double>(count);
    x += static_cast<double>(count) * center(bin);
    xx += static_cast<double>(count) * center(bin) * center(bin);
  }
  double mean() const { return x / n; }
  /// Sum of squared deviations from the mean.
  double scatter() const { return std::max(xx - x * x / n, 0.0); }
};

}  // namespace

EchoLevels measure_levels(const hw::AcquisitionPlan& plan,
                          const std::vector<std::vector<float>>& frames,
                          const std::vector<SampleSpan>& spans) {
  const auto [counts, white] = histogram(plan, frames, spans);
  Sums all;
  for (int bin = 0; bin < kBins; ++bin) all.add(bin, counts[static_cast<std::size_t>(bin)]);
  EchoLevels best;
  double least = all.scatter();
  Sums low;
  for (int bin = 0; bin + 1 < kBins; ++bin) {
    low.add(bin, counts[static_cast<std::size_t>(bin)]);
    const Sums high{all.n - low.n, all.x - low.x, all.xx - low.xx};
    if (low.n == 0 || high.n == 0) continue;
    // Otsu's criterion, the greatest scatter between classes, is the least within them.
    const double within = low.scatter() + high.scatter();
    if (within >= least) continue;
    least = within;
    const double deviation = std::sqrt(within / all.n);
    best = {low.mean(),
            high.mean(),
            high.mean() - low.mean() >= kLeastSeparation * deviation,
            static_cast<double>(white) / high.n};
  }
  return best;
}

std::vector<SampleSpan> spans_in_box(const hw::AcquisitionPlan& plan,
                                     const VolumeOfInterest& box,
                                     const MotorAngles& angles) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const double spacing_m = plan.sample_spacing_m();
  std::vector<SampleSpan> spans;
  for (int frame = 0; frame < scan.frames_per_volume; ++frame) {
    for (int line = 0; line < scan.sticks_per_frame; ++line) {
      const double phi_rad =
          angles.as_planned() ? plan.frame_phi_rad(frame) : angles.phi_rad[spans.size()];
      const hw::Ray axis = geometry.stick(plan.theta_rad(line), phi_rad);
      const Span inside = clip_to_box(axis, box);
      // Sample k lies at (k + 1/2) spacings.
      const auto first_from = [&](double range_m) {
        const double sample = std::ceil(range_m / spacing_m - 0.5);
        return static_cast<int>(std::clamp(sample, 0.0, double(scan.samples_per_stick)));
      };
      const bool misses = inside.to_m < inside.from_m;
      spans.push_back(misses ? SampleSpan{}
                             : SampleSpan{first_from(inside.from_m), first_from(inside.to_m)});
    }
  }
  return spans;
}

WindowMeans::WindowMeans(const float* samples, int count) {
  sums_.reserve(static_cast<std::size_t>(count) + 1);
  sums_.push_back(0);
  for (int k = 0; k < count; ++k) sums_.push_back(sums_.back() + static_cast<double>(samples[k]));
}

double WindowMeans::mean(int begin, int end) const {
  const int count = static_cast<int>(sums_.size()) - 1;
  begin = std::clamp(begin, 0, count);
  end = std::clamp(end, 0, count);
  if (end <= begin) return 0;
  const double sum = sums_[static_cast<std::size_t>(end)] - sums_[static_cast<std::size_t>(begin)];
  return sum / (end - begin);
}

int samples_in(double length_m, const hw::AcquisitionPlan& plan) {
  return std::max(1, static_cast<int>(std::lround(length_m / plan.sample_spacing_m())));
}

}  // namespace wobblebench::render
