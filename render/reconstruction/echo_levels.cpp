#include "render/reconstruction/echo_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"

namespace wobblebench::render {
namespace {

constexpr int kBins = 256;
using Histogram = std::array<std::uint64_t, kBins>;

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
    Histogram& counts = of_frame[static_cast<std::size_t>(frame)];
    for (int line = 0; line < lines; ++line) {
      const SampleSpan span = spans[static_cast<std::size_t>(frame * lines + line)];
      if (span.begin >= span.end) continue;
      const WindowMeans means(
          frames[static_cast<std::size_t>(frame)].data() + std::ptrdiff_t{line} * samples, samples);
      for (int k = span.begin; k < span.end; ++k) {
        const int bin =
            static_cast<int>(means.mean(k - window / 2, k - window / 2 + window) * kBins);
        ++counts[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1))];
      }
    }
  });
  Histogram total{};
  for (const Histogram& counts : of_frame) {
    for (int bin = 0; bin < kBins; ++bin) {
      total[static_cast<std::size_t>(bin)] += counts[static_cast<std::size_t>(bin)];
    }
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
  const Histogram counts = histogram(plan, frames, spans);
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
    best = {low.mean(), high.mean(), high.mean() - low.mean() >= kLeastSeparation * deviation};
  }
  return best;
}

}  // namespace wobblebench::render
