#include "bench/evaluation/head_pose/find_head.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/parallel.h"
#include "base/units.h"
#include "bench/evaluation/head_pose/facing_surface.h"
#include "phantoms/fetal/mean_head.h"

namespace wobblebench::bench {

namespace {

using Points = std::vector<glm::dvec3>;

/// Of a head; beyond, it is another body (docs/decisions/0063-a-frame-that-finds-itself.md).
constexpr double kLeastMatched = 0.36, kMostRival = 0.9;
constexpr double kOther_rad = 35 * kDegree;  // a rival's least angle

constexpr std::size_t kIslands = 4;                      // that may be the head
constexpr std::size_t kLeastSticks = 60;                 // of such an island
constexpr double kLeastRim = 0.45;                       // SurfaceIsland::free_rim of it
constexpr double kAround_m = 110e-3;                     // about its middle: fluid that counts
constexpr double kFluidStep_m = 8e-3;                    // between points where there is no tissue
constexpr double kBeforeEdge_m = 4e-3;                   // none of these is nearer to a surface
constexpr double kRoughMatch_m = 8e-3, kMatch_m = 4e-3;  // HeadPose::matched
constexpr double kLeastScale = 0.65, kMostScale = 1.4;
constexpr std::size_t kRefined = 32;  // poses that are fitted closely

struct Candidate {
  glm::dmat3 rotation{1.0};
  glm::dvec3 position_m{0};
  double log_scale = 0;
  double score = 0;  ///< the sum whose mean is HeadPose::matched
  double matched = 0, rival = 0;
};

/// Points on the surface and in the fluid before it.
struct Evidence {
  Points surface, fluid;
};

/// How poses are fitted and judged.
struct Schedule {
  int steps;
  double from_m, to_m;  ///< distances beyond it count little: of the first step, of the last
  std::size_t every;    ///< stick that is judged
  double match_m;
};

template <class T>
std::vector<T> spread(const std::vector<T>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

glm::dvec3 mean(const Points& points) {
  glm::dvec3 sum(0);
  for (const glm::dvec3& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

/// One step of Gauss and Newton with weights of Geman and McClure on the points of the surface;
/// points in fluid count where they lie within the head.
void step(Candidate& pose, const phantoms::MeanHead& head, const Evidence& evidence, double far_m) {
  using Vector = Eigen::Matrix<double, 7, 1>;  // rotation about the head's origin, place, log scale
  Eigen::Matrix<double, 7, 7> hessian = Eigen::Matrix<double, 7, 7>::Zero();
  Vector gradient = Vector::Zero();
  const double scale = std::exp(pose.log_scale);
  const glm::dmat3 to_head = glm::transpose(pose.rotation) / scale;
  const auto add = [&](const glm::dvec3& point, bool is_fluid) {
    const glm::dvec3 from = point - pose.position_m;
    const auto found = head.distance(to_head * from);
    const double error = scale * found.value_m;
    if (is_fluid && error >= 0) return;
    const double far = error / (is_fluid ? 12e-3 : far_m);
    const double weight = is_fluid ? 1 / (1 + far * far) : 1 / std::pow(1 + far * far, 2);
    const glm::dvec3 normal = pose.rotation * found.gradient;
    const glm::dvec3 turn = glm::cross(normal, from);
    Vector row;
    row << turn.x, turn.y, turn.z, -normal.x, -normal.y, -normal.z, error - glm::dot(normal, from);
    hessian += weight * row * row.transpose();
    gradient += weight * error * row;
  };
  for (const glm::dvec3& point : evidence.surface) add(point, false);
  for (const glm::dvec3& point : evidence.fluid) add(point, true);
  // What the points do not determine stays.
  const auto count = static_cast<double>(evidence.surface.size());
  Vector damping;
  damping << 20e-6, 20e-6, 20e-6, 0.02, 0.02, 0.02, 20e-6;
  hessian.diagonal() += count * damping;
  const Vector moved = -hessian.ldlt().solve(gradient);
  const glm::dvec3 turn = glm::clamp(glm::dvec3(moved[0], moved[1], moved[2]), -0.3, 0.3);
  if (glm::length(turn) > 0) {
    pose.rotation =
        glm::mat3_cast(glm::angleAxis(glm::length(turn), glm::normalize(turn))) * pose.rotation;
  }
  pose.position_m += glm::clamp(glm::dvec3(moved[3], moved[4], moved[5]), -10e-3, 10e-3);
  pose.log_scale = std::clamp(pose.log_scale + std::clamp(moved[6], -0.1, 0.1),
                              std::log(kLeastScale),
                              std::log(kMostScale));
}

void fit(Candidate& pose,
         const phantoms::MeanHead& head,
         const Evidence& evidence,
         const Schedule& schedule) {
  for (int i = 0; i < schedule.steps; ++i) {
    const double done = static_cast<double>(i) / (schedule.steps - 1);
    step(pose, head, evidence, schedule.from_m * std::pow(schedule.to_m / schedule.from_m, done));
  }
}

/// Range at which a stick meets the head; infinity where it does not.
double meets_at(const Candidate& pose, const phantoms::MeanHead& head, const hw::Ray& stick) {
  constexpr int kSteps = 40;
  constexpr double kNear_m = 0.5e-3, kShort = 0.85;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double scale = std::exp(pose.log_scale), reach_m = scale * head.reach_m();
  const glm::dmat3 to_head = glm::transpose(pose.rotation) / scale;
  const glm::dvec3 from = stick.origin - pose.position_m;
  const double middle = -glm::dot(from, stick.direction);
  const double half2 = reach_m * reach_m - (glm::dot(from, from) - middle * middle);
  if (half2 <= 0) return kNever;
  double range = std::max(0.0, middle - std::sqrt(half2));
  for (int i = 0; i < kSteps && range < middle + std::sqrt(half2); ++i) {
    const double gap = scale * head.distance(to_head * (from + range * stick.direction)).value_m;
    if (gap < kNear_m) return range;
    range += kShort * gap;
  }
  return kNever;
}

void judge(Candidate& pose,
           const phantoms::MeanHead& head,
           const FacingSurface& seen,
           const Schedule& schedule,
           double depth_m) {
  int met = 0;
  pose.score = 0;
  for (std::size_t stick = 0; stick < seen.sticks.size(); stick += schedule.every) {
    const double range = meets_at(pose, head, seen.sticks[stick]);
    if (range >= depth_m) continue;
    ++met;
    const double behind = (seen.edge_m[stick] - range) / schedule.match_m;
    if (!(behind < 1)) {
      pose.score -= 1;
    } else if (behind > -1) {
      pose.score += 1 - std::abs(behind);
    }
  }
  pose.matched = met > 0 ? pose.score / met : 0;
}

std::vector<glm::dmat3> facing_rotations() {
  std::vector<glm::dmat3> rotations;
  for (int roll = 0; roll < 360; roll += 30) {
    for (const int yaw : {-50, -25, 0, 25, 50}) {
      for (const int pitch : {-40, -15, 15, 40}) {
        rotations.push_back(phantoms::rotation_xyz(kDegree * glm::dvec3(pitch, yaw, 0)));
        rotations.back() = phantoms::rotation_xyz({0, 0, roll * kDegree}) * rotations.back();
      }
    }
  }
  return rotations;
}

/// Middle of what is seen along z of the head so turned, from its origin.
glm::dvec3 middle_of_seen(const phantoms::MeanHead& head, const glm::dmat3& rotation) {
  glm::dvec3 sum(0);
  double weights = 0;
  for (const auto& [position_m, normal] : head.skin()) {
    const double weight = std::max(0.0, -(rotation * normal).z);
    sum += weight * position_m;
    weights += weight;
  }
  return rotation * (sum / weights);
}

Points fluid_points(const FacingSurface& seen, double depth_m) {
  Points points;
  for (std::size_t i = 0; i < seen.sticks.size(); ++i) {
    const double end = std::isnan(seen.edge_m[i]) ? depth_m : seen.edge_m[i] - kBeforeEdge_m;
    for (double range = seen.fluid_m[i]; range < end; range += kFluidStep_m) {
      points.push_back(seen.sticks[i].at(range));
    }
  }
  return points;
}

Points points_of(const FacingSurface& seen, const SurfaceIsland& island) {
  Points points;
  for (const std::size_t stick : island.sticks) points.push_back(seen.point(stick));
  return points;
}

/// Those within kAround_m of a point.
Points near(const Points& points, const glm::dvec3& middle) {
  Points some;
  for (const glm::dvec3& point : points) {
    if (glm::distance(point, middle) < kAround_m) some.push_back(point);
  }
  return some;
}

double angle_rad(const Candidate& a, const Candidate& b) {
  const glm::dmat3 turn = glm::transpose(a.rotation) * b.rotation;
  return std::acos(std::clamp((turn[0].x + turn[1].y + turn[2].z - 1) / 2, -1.0, 1.0));
}

/// The islands that may be the head, the likeliest first.
std::vector<SurfaceIsland> likely_islands(const FacingSurface& seen) {
  std::vector<SurfaceIsland> islands;
  for (const SurfaceIsland& island : seen.islands) {
    if (island.sticks.size() >= kLeastSticks && island.free_rim > kLeastRim) {
      islands.push_back(island);
    }
  }
  const auto size = [](const SurfaceIsland& of) {
    return of.free_rim * static_cast<double>(of.sticks.size());
  };
  std::ranges::sort(islands, std::greater{}, size);
  if (islands.size() > kIslands) islands.resize(kIslands);
  return islands;
}

class HeadSearch {
 public:
  explicit HeadSearch(const hw::PolarVolume& volume)
      : seen_(find_facing_surface(volume)),
        depth_m_(volume.plan().acquisition().depth_m),
        fluid_(fluid_points(seen_, depth_m_)) {}

  Candidate best() const {
    Candidate best;
    for (const SurfaceIsland& island : likely_islands(seen_)) {
      const Candidate found = best_on(points_of(seen_, island));
      if (found.score > best.score) best = found;
    }
    return best;
  }

 private:
  /// The head whose face is this piece of surface.
  Candidate best_on(const Points& face) const {
    const glm::dvec3 middle = mean(face);
    const Points fluid = near(fluid_, middle);
    std::vector<Candidate> poses;
    for (const double scale : {0.72, 0.87, 1.05, 1.25}) {
      for (const glm::dmat3& rotation : facing_rotations()) {
        poses.push_back({.rotation = rotation,
                         .position_m = middle - scale * middle_of_seen(head_, rotation),
                         .log_scale = std::log(scale)});
      }
    }
    improve(poses, {spread(face, 250), spread(fluid, 250)}, {6, 12e-3, 6e-3, 4, kRoughMatch_m});
    poses.resize(kRefined);
    improve(poses, {spread(face, 700), spread(fluid, 700)}, {12, 7e-3, 3e-3, 1, kMatch_m});
    Candidate best = poses.front();
    const auto rival = std::ranges::find_if(
        poses, [&](const Candidate& one) { return angle_rad(one, best) > kOther_rad; });
    if (rival != poses.end()) best.rival = rival->score / best.score;
    return best;
  }
  void improve(std::vector<Candidate>& poses,
               const Evidence& evidence,
               const Schedule& schedule) const {
    parallel_rows(static_cast<int>(poses.size()), [&](int row) {
      Candidate& pose = poses[static_cast<std::size_t>(row)];
      fit(pose, head_, evidence, schedule);
      judge(pose, head_, seen_, schedule, depth_m_);
    });
    std::ranges::stable_sort(poses, std::greater{}, &Candidate::score);
  }

  phantoms::MeanHead head_;
  FacingSurface seen_;
  double depth_m_;
  Points fluid_;
};

double whole(double value, double unit) {
  return std::round(value / unit) * unit;
}

}  // namespace

bool HeadPose::is_head() const {
  return matched >= kLeastMatched && rival <= kMostRival;
}

HeadPose find_head(const hw::PolarVolume& volume) {
  const Candidate found = HeadSearch(volume).best();
  return {found.rotation, found.position_m, std::exp(found.log_scale), found.matched, found.rival};
}

HeadView head_view(const HeadPose& pose) {
  constexpr double kRoom_m = 10e-3;     // for a head that is not the mean one
  const glm::dmat3& r = pose.rotation;  // its columns: right, down and forward of the camera
  HeadView shown;
  // docs/units.md, The camera.
  shown.view.pitch_rad = whole(std::asin(std::clamp(r[2].y, -1.0, 1.0)), kDegree);
  shown.view.yaw_rad = whole(std::atan2(-r[2].x, r[2].z), kDegree);
  const glm::dmat3 unturned = phantoms::rotation_xyz({shown.view.pitch_rad, 0, 0}) *
                              phantoms::rotation_xyz({0, shown.view.yaw_rad, 0}) * r;
  shown.view.roll_rad = whole(std::atan2(unturned[0].y, unturned[0].x), kDegree);

  const phantoms::MeanHead head;
  const phantoms::Box bounds = head.turned_bounds(r);
  glm::dvec3 middle = pose.position_m + 0.5 * pose.scale * (bounds.low + bounds.high);
  glm::dvec3 size = pose.scale * (bounds.high - bounds.low) + 2 * kRoom_m;
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = whole(middle[axis], kMillimetre);
    size[axis] = std::ceil(size[axis] / kMillimetre) * kMillimetre;
  }
  // The picture is as wide as the box, but lies along the head.
  const glm::dvec3 offset = glm::transpose(r) * (middle - pose.position_m);
  double half_m = 0;
  for (const auto& skin : head.skin()) {
    const glm::dvec3 from = glm::abs(pose.scale * skin.position_m - offset) + 0.5 * kRoom_m;
    half_m = std::max({half_m, from.x, from.y});
  }
  double& longer = size.x > size.y ? size.x : size.y;
  longer = std::max(longer, std::ceil(2 * half_m / kMillimetre) * kMillimetre);
  shown.box = {middle, size};
  return shown;
}

nlohmann::ordered_json settings_of(const HeadView& head) {
  const auto degrees = [](double angle_rad) { return std::lround(angle_rad / kDegree); };
  const auto millimetres = [](const glm::dvec3& v) {
    return nlohmann::ordered_json{std::lround(v.x / kMillimetre),
                                  std::lround(v.y / kMillimetre),
                                  std::lround(v.z / kMillimetre)};
  };
  return {{"render.volume_of_interest.center_mm", millimetres(head.box.center_m)},
          {"render.volume_of_interest.size_mm", millimetres(head.box.size_m)},
          {"render.view.yaw_deg", degrees(head.view.yaw_rad)},
          {"render.view.pitch_deg", degrees(head.view.pitch_rad)},
          {"render.view.roll_deg", degrees(head.view.roll_rad)}};
}

std::string set_head_view(const HeadView& head, Scene& scene) {
  std::string set, kept;
  const auto settings = settings_of(head);
  for (const auto& [key, value] : settings.items()) {
    if (scene.given.contains(key)) {
      kept += " " + key;
    } else {
      set += (set.empty() ? "--set '" : " --set '") + key + "=" + value.dump() + "'";
    }
  }
  const auto take = [&](const char* key, auto& to, const auto& from) {
    if (!scene.given.contains(key)) to = from;
  };
  render::RenderOptions& to = scene.render;
  take("render.volume_of_interest.center_mm", to.volume_of_interest.center_m, head.box.center_m);
  take("render.volume_of_interest.size_mm", to.volume_of_interest.size_m, head.box.size_m);
  take("render.view.yaw_deg", to.view.yaw_rad, head.view.yaw_rad);
  take("render.view.pitch_deg", to.view.pitch_rad, head.view.pitch_rad);
  take("render.view.roll_deg", to.view.roll_rad, head.view.roll_rad);
  return set + (kept.empty() ? "" : "; given, and kept:" + kept);
}

}  // namespace wobblebench::bench
