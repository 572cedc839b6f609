#include "sim/speckle/scatterers/points_in_beam.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

constexpr double kPulseSamples = 8;  ///< by which a pulse extends beyond its scatterer's sample
/// What rounding to float may move a point by, and more.
constexpr double kRounding_m = 1e-6;

/// A line, and what is near it.
struct Cylinder {
  glm::vec3 from;
  glm::vec3 along;  ///< unit
  float length_m;
  float radius_m;
};

/// near[i] = 1 for points within the cylinder, else 0.
WOBBLEBENCH_SIMD void find_near(const Cylinder& in,
                                const float* x,
                                const float* y,
                                const float* z,
                                int count,
                                std::uint8_t* __restrict near) {
  const float most = in.radius_m * in.radius_m;
  for (int i = 0; i < count; ++i) {
    const float dx = x[i] - in.from.x, dy = y[i] - in.from.y, dz = z[i] - in.from.z;
    const float t = dx * in.along.x + dy * in.along.y + dz * in.along.z;
    const float ax = dx - t * in.along.x, ay = dy - t * in.along.y, az = dz - t * in.along.z;
    near[i] = (t > -in.radius_m) & (t < in.length_m) & (ax * ax + ay * ay + az * az < most);
  }
}

}  // namespace

double echo_range_m(const StickPath& path) {
  const double delay_m = path.delay_m.empty() ? 0 : static_cast<double>(path.delay_m.back());
  const double to_m = (static_cast<double>(path.remaining.size()) + kPulseSamples) * path.spacing_m;
  return to_m - delay_m;
}

PointsInBeam::PointsInBeam(const ScannedTissue& tissue, const BeamTable& beam)
    : tissue_(tissue), rows_per_m_(beam.rows_per_m()) {
  for (int row = 0; row < beam.rows(); ++row) {
    const Reach& reach = reaches_.emplace_back(
        Reach{beam.lateral_reach_m(row), beam.reach_m(beam.elevation(), row)});
    widest_m_ = std::max({widest_m_, reach.lateral_m, reach.elevation_m});
  }
  const std::size_t count = tissue.points ? tissue.points->size() : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool fixed = tissue.points->fixed(i);
    (fixed ? fixed_ : moving_).push_back(static_cast<std::uint32_t>(i));
    if (!fixed) continue;
    const glm::dvec3& at = tissue.points->track(i).front().point.position_m;
    x_m_.push_back(static_cast<float>(at.x));
    y_m_.push_back(static_cast<float>(at.y));
    z_m_.push_back(static_cast<float>(at.z));
  }
  near_.resize(fixed_.size());
}

std::span<const PointEcho> PointsInBeam::find(const StickPath& path) {
  if (path.remaining.empty()) return {};
  return find(path.line, echo_range_m(path));
}

std::span<const PointEcho> PointsInBeam::find(const TimedRay& line, double to_m) {
  found_.clear();
  const Stick stick{line.ray, across_stick(line.ray), to_m, tissue_.motion.at(line.time_s)};
  if (!fixed_.empty()) find_fixed(stick);
  for (const std::uint32_t i : moving_) add_if_near(tissue_.points->at(i, line.time_s), stick);
  return found_;
}

void PointsInBeam::find_fixed(const Stick& stick) {
  if (tissue_.motion.rigid()) {
    // The axis at rest is straight: only the points near it need their places now.
    const auto to_rest = [&](const glm::dvec3& probe_m) {
      return stick.now.to_rest(tissue_.placement.to_phantom(probe_m));
    };
    const glm::dvec3 from = to_rest(stick.ray.origin);
    find_near({glm::vec3(from),
               glm::vec3(glm::normalize(to_rest(stick.ray.at(1)) - from)),
               static_cast<float>(stick.to_m + kRounding_m),
               static_cast<float>(widest_m_ + kRounding_m)},
              x_m_.data(),
              y_m_.data(),
              z_m_.data(),
              static_cast<int>(fixed_.size()),
              near_.data());
  } else {
    std::ranges::fill(near_, std::uint8_t{1});
  }
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (near_[i] != 0) add_if_near(tissue_.points->track(fixed_[i]).front().point, stick);
  }
}

void PointsInBeam::add_if_near(const phantoms::PointScatterer& point, const Stick& stick) {
  const glm::dvec3 now_m = tissue_.placement.to_probe(stick.now.from_rest(point.position_m));
  const glm::dvec3 from_face = now_m - stick.ray.origin;
  const double range_m = glm::dot(from_face, stick.ray.direction);
  if (range_m <= 0 || range_m >= stick.to_m) return;
  const auto last = static_cast<double>(reaches_.size() - 1);
  const Reach& reach = reaches_[static_cast<std::size_t>(std::min(range_m * rows_per_m_, last))];
  const double u = glm::dot(from_face, stick.across.lateral) / reach.lateral_m;
  const double v = glm::dot(from_face, stick.across.elevation) / reach.elevation_m;
  if (u * u + v * v < 1) found_.push_back({now_m, static_cast<float>(point.amplitude)});
}

}  // namespace wobblebench::sim
