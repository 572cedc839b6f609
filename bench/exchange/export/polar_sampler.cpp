#include "bench/exchange/export/polar_sampler.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::bench {

namespace {

constexpr double kSlack = 1e-9;  // of rounding, in sticks or samples

}  // namespace

PolarSampler::PolarSampler(const hw::PolarVolume& volume)
    : volume_(volume), geometry_(volume.plan().geometry()) {
  const hw::AcquisitionOptions& scan = volume.plan().acquisition();
  angles_.resize(static_cast<std::size_t>(scan.sticks_per_frame));
  for (std::size_t line = 0; line < angles_.size(); ++line) {
    for (int frame = 0; frame < scan.frames_per_volume; ++frame) {
      angles_[line].emplace_back(volume.frame(frame).motor_angle_rad[line], frame);
    }
    std::ranges::sort(angles_[line]);
  }
}

std::optional<PolarSampler::Between> PolarSampler::samples(double range_m) const {
  const int count = volume_.plan().acquisition().samples_per_stick;
  const double at = range_m / volume_.plan().sample_spacing_m() - 0.5;
  // The first and the last cell reach half a sample beyond their middle.
  if (at < -0.5 - kSlack || at > count - 0.5 + kSlack) return {};
  const double within = std::clamp(at, 0.0, static_cast<double>(count - 1));
  const int first = std::min(static_cast<int>(within), std::max(count - 2, 0));
  return Between{first, std::min(first + 1, count - 1), within - first};
}

std::optional<PolarSampler::Between> PolarSampler::lines(double theta_rad) const {
  const hw::AcquisitionOptions& scan = volume_.plan().acquisition();
  const double step_rad = volume_.plan().theta_step_rad();
  if (step_rad == 0)
    return std::abs(theta_rad) < kSlack ? std::optional<Between>(Between{}) : std::nullopt;
  const double at = (theta_rad - volume_.plan().theta_rad(0)) / step_rad;
  const int last = scan.sticks_per_frame - 1;
  if (at < -kSlack || at > last + kSlack) return {};
  const double within = std::clamp(at, 0.0, static_cast<double>(last));
  const int first = std::min(static_cast<int>(within), last - 1);
  return Between{first, first + 1, within - first};
}

std::optional<PolarSampler::Between> PolarSampler::frames(int line, double phi_rad) const {
  const auto& angles = angles_[static_cast<std::size_t>(line)];
  if (phi_rad < angles.front().first - kSlack || phi_rad > angles.back().first + kSlack) return {};
  auto above = std::ranges::lower_bound(angles, std::pair(phi_rad, -1));
  if (above == angles.end()) --above;
  if (above == angles.begin()) return Between{above->second, above->second, 0};
  const auto below = above - 1;
  const double gap_rad = above->first - below->first;
  const double share = gap_rad > 0 ? (phi_rad - below->first) / gap_rad : 0;
  return Between{below->second, above->second, std::clamp(share, 0.0, 1.0)};
}

double PolarSampler::in_stick(int frame, int line, const Between& samples) const {
  const int count = volume_.plan().acquisition().samples_per_stick;
  const float* stick = volume_.frame(frame).samples.data() +
                       static_cast<std::ptrdiff_t>(line) * static_cast<std::ptrdiff_t>(count);
  return (1 - samples.share) * stick[samples.first] + samples.share * stick[samples.second];
}

std::optional<double> PolarSampler::at(const hw::PolarPoint& point) const {
  const auto range = samples(point.range_m);
  const auto across = range ? lines(point.theta_rad) : std::nullopt;
  if (!across) return {};
  double sum = 0;
  for (const auto& [line, weight] :
       {std::pair(across->first, 1 - across->share), std::pair(across->second, across->share)}) {
    if (weight == 0) continue;
    const auto fan = frames(line, point.phi_rad);
    if (!fan) return {};
    sum += weight * ((1 - fan->share) * in_stick(fan->first, line, *range) +
                     fan->share * in_stick(fan->second, line, *range));
  }
  return sum;
}

std::optional<double> PolarSampler::at(const glm::dvec3& position_m) const {
  return at(geometry_.to_polar(position_m));
}

std::optional<double> PolarSampler::in_frame(int frame, double radius_m, double theta_rad) const {
  const auto range = samples(radius_m - geometry_.radius_m());
  const auto across = range ? lines(theta_rad) : std::nullopt;
  if (!across) return {};
  return (1 - across->share) * in_stick(frame, across->first, *range) +
         across->share * in_stick(frame, across->second, *range);
}

}  // namespace wobblebench::bench
