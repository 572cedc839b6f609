#include "render/reference/reference_detectors.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "render/camera.h"
#include "render/geometry/ray_sampling.h"

namespace wobblebench::render::reference {
namespace {

double sign_of(EdgeSign edge) {
  return edge == EdgeSign::rising ? 1 : -1;
}

/// Difference of Eq. (1): the newer half of the buffer minus the older half; negated for falling
/// edges.
class PaperFinder : public SurfaceFinder {
 public:
  explicit PaperFinder(const RenderOptions& options)
      : o_(options.ray_casting),
        step_m_(step_m(options)),
        n_(static_cast<std::size_t>(buffer_samples(options))) {}

  void reset() override {
    buffer_.clear();
    last_difference_.reset();
  }
  std::optional<double> take(double sample, double distance_m) override {
    buffer_.push_back(sample);
    if (buffer_.size() < n_) return {};
    if (buffer_.size() > n_) buffer_.pop_front();
    const double now = difference();
    const std::optional<double> before = std::exchange(last_difference_, now);
    if (now < o_.threshold) return {};
    if (!o_.refine_crossing || !before) return distance_m;
    return distance_m - step_m_ * (now - o_.threshold) / (now - *before);
  }

 private:
  double difference() const {
    const auto middle = buffer_.begin() + static_cast<std::ptrdiff_t>(buffer_.size() / 2);
    const double older = std::accumulate(buffer_.begin(), middle, 0.0);
    const double newer = std::accumulate(middle, buffer_.end(), 0.0);
    return sign_of(o_.edge) * (newer - older);
  }

  RayCastingOptions o_;
  double step_m_;
  std::size_t n_;
  std::deque<double> buffer_;
  std::optional<double> last_difference_;
};

/// An iso-surface.
class IsoFinder : public SurfaceFinder {
 public:
  IsoFinder(const RayCastingOptions& options, double step_m, double level)
      : o_(options), step_m_(step_m), level_(level) {}

  void reset() override { last_.reset(); }
  std::optional<double> take(double sample, double distance_m) override {
    const double now = sign_of(o_.edge) * (sample - level_);
    const std::optional<double> before = std::exchange(last_, now);
    if (!before || *before >= 0 || now < 0) return {};
    return o_.refine_crossing ? distance_m - step_m_ * now / (now - *before) : distance_m;
  }

 private:
  RayCastingOptions o_;
  double step_m_, level_;
  std::optional<double> last_;  ///< how far beyond the level the sample before was
};

/// A rise of the mean over a millimetre above the least such mean of the last eleven.
class FloorFinder : public SurfaceFinder {
 public:
  FloorFinder(const RenderOptions& options, double rise)
      : o_(options.ray_casting),
        step_m_(step_m(options)),
        samples_(floor_mean_samples(options)),
        rise_(rise) {}

  void reset() override {
    buffer_.clear();
    means_.push_back(kNoMean);
    std::ranges::fill(means_, kNoMean);
    last_rise_ = 0;
  }
  std::optional<double> take(double sample, double distance_m) override {
    means_.push_back(kNoMean);
    buffer_.push_back(sample);
    if (buffer_.size() < static_cast<std::size_t>(samples_)) return {};
    if (buffer_.size() > static_cast<std::size_t>(samples_)) buffer_.pop_front();
    means_.back() =
        sign_of(o_.edge) * std::accumulate(buffer_.begin(), buffer_.end(), 0.0) / samples_;
    const double now = means_.back() - floor();
    const double before = std::exchange(last_rise_, now);
    if (now < rise_) return {};
    const double middle_m = distance_m - 0.5 * (samples_ - 1) * step_m_;
    return o_.refine_crossing ? middle_m - step_m_ * (now - rise_) / (now - before) : middle_m;
  }

 private:
  static constexpr double kNoMean = std::numeric_limits<double>::infinity();

  /// The least mean of the block of `samples_` steps that the last one belongs to, and of the
  /// kFloorBlocks blocks before; blocks are counted from the ray's first step.
  double floor() const {
    const auto blocks_before = (means_.size() - 1) / static_cast<std::size_t>(samples_);
    const auto first = blocks_before - std::min<std::size_t>(blocks_before, kFloorBlocks);
    const auto begin = static_cast<std::ptrdiff_t>(first) * samples_;
    return *std::min_element(means_.begin() + begin, means_.end());
  }

  RayCastingOptions o_;
  double step_m_;
  int samples_;
  double rise_;
  std::deque<double> buffer_;
  std::vector<double> means_;  ///< of each step; none before the cone and its first millimetre
  double last_rise_ = 0;
};

}  // namespace

std::unique_ptr<SurfaceFinder> make_surface_finder(const RenderOptions& options, double level) {
  switch (options.ray_casting.detector) {
    case Detector::iso:
      return std::make_unique<IsoFinder>(options.ray_casting, step_m(options), level);
    case Detector::floor:
      return std::make_unique<FloorFinder>(options, level);
    case Detector::paper:
      break;
  }
  return std::make_unique<PaperFinder>(options);
}

}  // namespace wobblebench::render::reference
