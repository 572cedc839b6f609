#include "bench/scene/motion_bounds.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

namespace wobblebench::bench {
namespace {

constexpr int kPointsAcross = 9;
constexpr int kSteps = 128;
constexpr double kSpeedMargin = 1.5, kStretchMargin = 1.2;
/// Margin beyond the sampled points, where a phantom bends.
constexpr double kBend_m = 2e-3;
constexpr double kNeighbour_m = 1e-4;

std::vector<glm::dvec3> grid_points(const phantoms::Box& box) {
  const glm::dvec3 step = (box.high - box.low) / (kPointsAcross - 1.0);
  std::vector<glm::dvec3> points;
  for (int x = 0; x < kPointsAcross; ++x) {
    for (int y = 0; y < kPointsAcross; ++y) {
      for (int z = 0; z < kPointsAcross; ++z)
        points.push_back(box.low + step * glm::dvec3(x, y, z));
    }
  }
  return points;
}

/// Largest distance at rest of two neighbouring points over their distance now.
double stretch_at(const phantoms::Deformation& moment,
                  const glm::dvec3& now_m,
                  const glm::dvec3& rest) {
  double stretch = 1;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 neighbour = now_m;
    neighbour[axis] += kNeighbour_m;
    stretch = std::max(stretch, glm::distance(moment.to_rest(neighbour), rest) / kNeighbour_m);
  }
  return stretch;
}

/// Of a motion without a mouth, which is smooth enough to be sampled.
MotionBounds sampled_bounds(const phantoms::Motion& motion,
                            const phantoms::Box& box,
                            double begin_s,
                            double end_s) {
  MotionBounds bounds{0, 1, box};
  if (motion.still()) return bounds;
  const std::vector<glm::dvec3> points = grid_points(box);
  std::vector<glm::dvec3> before = points;
  const phantoms::Deformation start = motion.at(begin_s);
  for (glm::dvec3& point : before) {
    point = start.to_rest(point);
    bounds.at_rest = {glm::min(bounds.at_rest.low, point), glm::max(bounds.at_rest.high, point)};
  }
  const double step_s = (end_s - begin_s) / kSteps;
  for (int i = 1; i <= kSteps; ++i) {
    const phantoms::Deformation moment = motion.at(begin_s + i * step_s);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const glm::dvec3 rest = moment.to_rest(points[p]);
      bounds.speed_m_s = std::max(bounds.speed_m_s, glm::distance(rest, before[p]) / step_s);
      bounds.at_rest = {glm::min(bounds.at_rest.low, rest), glm::max(bounds.at_rest.high, rest)};
      if (!motion.rigid()) {
        bounds.stretch = std::max(bounds.stretch, stretch_at(moment, points[p], rest));
      }
      before[p] = rest;
    }
  }
  bounds.speed_m_s *= kSpeedMargin;
  if (motion.rigid()) return bounds;
  bounds.stretch *= kStretchMargin;
  bounds.at_rest = {bounds.at_rest.low - kBend_m, bounds.at_rest.high + kBend_m};
  return bounds;
}

}  // namespace

MotionBounds motion_bounds(const phantoms::Motion& motion,
                           const phantoms::Box& box,
                           double begin_s,
                           double end_s) {
  MotionBounds bounds = sampled_bounds(motion.without_mouth(), box, begin_s, end_s);
  // The mouth is smaller than the samples' spacing: its bounds are in closed form.
  const phantoms::Motion::MouthBounds mouth = motion.mouth_bounds();
  bounds.speed_m_s = mouth.stretch * bounds.speed_m_s + mouth.speed_m_s;
  bounds.stretch *= mouth.stretch;
  bounds.at_rest.low -= mouth.shift_m;
  bounds.at_rest.high += mouth.shift_m;
  return bounds;
}

}  // namespace wobblebench::bench
