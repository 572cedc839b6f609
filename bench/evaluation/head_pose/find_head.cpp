#include "bench/evaluation/head_pose/find_head.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <limits>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/evaluation/head_pose/facing_surface.h"
#include "phantoms/fetal/mean_head.h"

namespace wobblebench::bench {

namespace {

using Points = std::vector<glm::dvec3>;

/// Candidate::matched and rival of a head; beyond, it is another body
/// (docs/decisions/0063-view-from-the-echoes.md).
constexpr double kLeastMatched = 0.36, kMostRival = 0.85;
constexpr double kOther_rad = 35 * kDegree;  // a rival's least angle

constexpr std::size_t kIslands = 4;                      // that may be the head
constexpr std::size_t kLeastSticks = 60;                 // of such an island
constexpr double kLeastRim = 0.45;                       // SurfaceIsland::free_rim of it
constexpr double kAround_m = 110e-3;                     // about its middle: fluid that counts
constexpr double kRoughMatch_m = 8e-3, kMatch_m = 4e-3;  // Candidate::matched
constexpr double kBehindFace_m = 30e-3;  // the mean head's middle, of what is seen of it
constexpr double kLeastScale = 0.65, kMostScale = 1.4;
constexpr std::size_t kRefined = 64;  // poses that are fitted closely

/// From the frame of phantoms::MeanHead to the probe frame: scale * rotation * head + position.
struct Candidate {
  glm::dmat3 rotation{1.0};
  glm::dvec3 position_m{0};
  double log_scale = 0;
  double score = 0;  ///< of all sticks that meet the head; `matched`: their mean
  /// 1: each stick has its edge on the head; an edge match_m before it counts 0, one as far behind
  /// it, or none, -1.
  double matched = 0;
  /// The best score of another orientation over this one: near 1 of a ball, which has no face.
  double rival = 0;

  double scale() const { return std::exp(log_scale); }
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

double angle_rad(const Candidate& a, const Candidate& b) {
  const glm::dmat3 turn = glm::transpose(a.rotation) * b.rotation;
  return std::acos(std::clamp((turn[0].x + turn[1].y + turn[2].z - 1) / 2, -1.0, 1.0));
}

/// The islands that may be the head, the likeliest first.
std::vector<SurfaceIsland> likely_islands(const FacingSurface& seen) {
  std::vector<SurfaceIsland> islands;
  for (const SurfaceIsland& island : seen.islands) {
    if (island.points.size() >= kLeastSticks && island.free_rim > kLeastRim) {
      islands.push_back(island);
    }
  }
  const auto size = [](const SurfaceIsland& of) {
    return of.free_rim * static_cast<double>(of.points.size());
  };
  std::ranges::sort(islands, std::greater{}, size);
  if (islands.size() > kIslands) islands.resize(kIslands);
  return islands;
}

class HeadSearch {
 public:
  HeadSearch(const hw::AcquisitionPlan& plan, const std::vector<hw::PolarFrame>& frames)
      : seen_(find_facing_surface(plan, frames)), depth_m_(plan.acquisition().depth_m) {}

  Candidate best() const {
    Candidate best;
    for (const SurfaceIsland& island : likely_islands(seen_)) {
      const Candidate found = best_on(island.points);
      if (found.score > best.score) best = found;
    }
    return best;
  }

 private:
  /// The head whose face is this piece of surface.
  Candidate best_on(const Points& face) const {
    const glm::dvec3 middle =
        std::accumulate(face.begin(), face.end(), glm::dvec3(0)) / static_cast<double>(face.size());
    Points fluid;
    std::ranges::copy_if(seen_.fluid, std::back_inserter(fluid), [&](const glm::dvec3& point) {
      return glm::distance(point, middle) < kAround_m;
    });
    std::vector<Candidate> poses;
    for (const double scale : {0.72, 0.87, 1.05, 1.25}) {
      for (const glm::dmat3& rotation : facing_rotations()) {
        poses.push_back({.rotation = rotation,
                         .position_m = middle + glm::dvec3(0, 0, scale * kBehindFace_m),
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
      for (int i = 0; i < schedule.steps; ++i) {
        const double done = static_cast<double>(i) / (schedule.steps - 1);
        step(pose, evidence, std::lerp(schedule.from_m, schedule.to_m, done));
      }
      judge(pose, schedule);
    });
    std::ranges::stable_sort(poses, std::greater{}, &Candidate::score);
  }

  /// One step of Gauss and Newton with weights of Geman and McClure on the points of the surface;
  /// points in fluid count where they lie within the head.
  void step(Candidate& pose, const Evidence& evidence, double far_m) const {
    using Vector =
        Eigen::Matrix<double, 7, 1>;  // rotation about the head's origin, place, log scale
    Eigen::Matrix<double, 7, 7> hessian = Eigen::Matrix<double, 7, 7>::Zero();
    Vector gradient = Vector::Zero();
    const double scale = pose.scale();
    const glm::dmat3 to_head = glm::transpose(pose.rotation) / scale;
    const auto add = [&](const glm::dvec3& point, bool is_fluid) {
      const glm::dvec3 from = point - pose.position_m;
      const auto found = head_.distance(to_head * from);
      const double error = scale * found.value_m;
      if (is_fluid && error >= 0) return;
      const double far = error / (is_fluid ? 12e-3 : far_m);
      const double weight = is_fluid ? 1 / (1 + far * far) : 1 / std::pow(1 + far * far, 2);
      const glm::dvec3 normal = pose.rotation * found.gradient;
      const glm::dvec3 turn = glm::cross(normal, from);
      Vector row;
      row << turn.x, turn.y, turn.z, -normal.x, -normal.y, -normal.z,
          error - glm::dot(normal, from);
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

  /// Range at which a stick meets the head; infinity where it does not.
  double meets_at(const Candidate& pose, const hw::Ray& stick) const {
    constexpr int kSteps = 40;
    constexpr double kNear_m = 0.5e-3, kShort = 0.85;
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const double scale = pose.scale(), reach_m = scale * head_.reach_m();
    const glm::dmat3 to_head = glm::transpose(pose.rotation) / scale;
    const glm::dvec3 from = stick.origin - pose.position_m;
    const double middle = -glm::dot(from, stick.direction);
    const double half2 = reach_m * reach_m - (glm::dot(from, from) - middle * middle);
    if (half2 <= 0) return kNever;
    double range = std::max(0.0, middle - std::sqrt(half2));
    for (int i = 0; i < kSteps && range < middle + std::sqrt(half2); ++i) {
      const double gap = scale * head_.distance(to_head * (from + range * stick.direction)).value_m;
      if (gap < kNear_m) return range;
      range += kShort * gap;
    }
    return kNever;
  }

  void judge(Candidate& pose, const Schedule& schedule) const {
    int met = 0;
    pose.score = 0;
    for (std::size_t stick = 0; stick < seen_.sticks.size(); stick += schedule.every) {
      const double range = meets_at(pose, seen_.sticks[stick]);
      if (range >= depth_m_) continue;
      ++met;
      const double behind = (seen_.edge_m[stick] - range) / schedule.match_m;
      if (!(behind < 1)) {
        pose.score -= 1;
      } else if (behind > -1) {
        pose.score += 1 - std::abs(behind);
      }
    }
    pose.matched = met > 0 ? pose.score / met : 0;
  }

  phantoms::MeanHead head_;
  FacingSurface seen_;
  double depth_m_;
};

std::vector<std::string> settings_of(const Candidate& pose) {
  constexpr double kRoom_m = 10e-3;     // for a head that is not the mean one
  const glm::dmat3& r = pose.rotation;  // its columns: right, down and forward of the camera
  // docs/units.md, The camera.
  const double pitch_rad = std::asin(std::clamp(r[2].y, -1.0, 1.0));
  const double yaw_rad = std::atan2(-r[2].x, r[2].z);
  const glm::dmat3 rolled =
      phantoms::rotation_xyz({pitch_rad, 0, 0}) * phantoms::rotation_xyz({0, yaw_rad, 0}) * r;
  const double roll_rad = std::atan2(rolled[0].y, rolled[0].x);

  const phantoms::MeanHead head;
  const phantoms::Box bounds = head.turned_bounds(r);
  const glm::dvec3 from_middle = 0.5 * pose.scale() * (bounds.low + bounds.high);
  glm::dvec3 size = pose.scale() * (bounds.high - bounds.low) + 2 * kRoom_m;
  // The picture is as wide as the box, but lies along the head.
  const glm::dvec3 offset = glm::transpose(r) * from_middle;
  double& longer = size.x > size.y ? size.x : size.y;
  for (const glm::dvec3& skin_m : head.skin_m()) {
    const glm::dvec3 from = glm::abs(pose.scale() * skin_m - offset);
    longer = std::max(longer, 2 * std::max(from.x, from.y) + kRoom_m);
  }
  const auto whole = [](double value, double unit) {
    return std::to_string(std::lround(value / unit));
  };
  const auto millimetres = [&](const glm::dvec3& v) {
    return "[" + whole(v.x, kMillimetre) + ", " + whole(v.y, kMillimetre) + ", " +
           whole(v.z, kMillimetre) + "]";
  };
  return {"render.volume_of_interest.center_mm=" + millimetres(pose.position_m + from_middle),
          "render.volume_of_interest.size_mm=" + millimetres(size),
          "render.view.yaw_deg=" + whole(yaw_rad, kDegree),
          "render.view.pitch_deg=" + whole(pitch_rad, kDegree),
          "render.view.roll_deg=" + whole(roll_rad, kDegree)};
}

}  // namespace

std::vector<std::string> find_head_view(const hw::AcquisitionPlan& plan,
                                        const std::vector<hw::PolarFrame>& frames,
                                        const std::string& asked_by) {
  const Candidate found = HeadSearch(plan, frames).best();
  if (found.matched < kLeastMatched || found.rival > kMostRival) {
    throw UserError(asked_by +
                    ": no head was found behind fluid in this scan, or its face is turned away: "
                    "render.view and render.volume_of_interest must be given");
  }
  return settings_of(found);
}

}  // namespace wobblebench::bench
