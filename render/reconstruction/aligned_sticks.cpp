#include "render/reconstruction/aligned_sticks.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace wobblebench::render {
namespace {

std::array<double, 4> b_spline(double t) {
  const double s = 1 - t;
  return {s * s * s / 6,
          (3 * t * t * t - 6 * t * t + 4) / 6,
          (3 * s * s * s - 6 * s * s + 4) / 6,
          t * t * t / 6};
}

/// Of four values at -1, 0, 1 and 2.
double catmull_rom(const std::array<double, 4>& p, double t) {
  return p[1] +
         0.5 * t *
             (p[2] - p[0] +
              t * (2 * p[0] - 5 * p[1] + 4 * p[2] - p[3] + t * (3 * (p[1] - p[2]) + p[3] - p[0])));
}

/// Which of four neighbours lie on the surface of the nearer middle one, and the edge between them.
struct CommonSurface {
  std::array<bool, 4> on{};
  double edge_m = std::numeric_limits<double>::quiet_NaN();
};

CommonSurface common_surface(const std::array<StickView, 4>& sticks, double t, double reach_m) {
  const auto found = [&](int j) { return !std::isnan(sticks[j].edge_m); };
  const auto joined = [&](int j, int k) {
    return std::abs(sticks[j].edge_m - sticks[k].edge_m) < reach_m;  // false for NaN
  };
  CommonSurface surface;
  const int near = t <= 0.5 ? 1 : 2, far = 3 - near;
  if (!found(near) && !found(far)) return surface;
  const int own = found(near) ? near : far, other = 3 - own;
  surface.on[own] = true;
  surface.on[other] = joined(own, other);
  surface.on[0] = surface.on[1] && joined(0, 1);
  surface.on[3] = surface.on[2] && joined(3, 2);
  // Where a neighbour lies on another surface, this one goes on straight.
  std::array<double, 4> e{sticks[0].edge_m, sticks[1].edge_m, sticks[2].edge_m, sticks[3].edge_m};
  if (!surface.on[1]) e[1] = surface.on[3] ? 2 * e[2] - e[3] : e[2];
  if (!surface.on[2]) e[2] = surface.on[0] ? 2 * e[1] - e[0] : e[1];
  if (!surface.on[0]) e[0] = 2 * e[1] - e[2];
  if (!surface.on[3]) e[3] = 2 * e[2] - e[1];
  surface.edge_m = catmull_rom(e, t);
  return surface;
}

/// Adds weight times the stick, read `shift` samples deeper, constant beyond its ends.
void add_shifted(const float* stick, double shift, float weight, int count, float* sum) {
  const double whole = std::floor(shift);
  const auto fraction = static_cast<float>(shift - whole);
  const int offset = static_cast<int>(std::clamp(whole, -1.0 * count, 1.0 * count));
  const float near = weight * (1 - fraction), far = weight * fraction;
  const int begin = std::clamp(-offset, 0, count),
            end = std::clamp(count - 1 - offset, begin, count);
  for (int k = 0; k < begin; ++k) sum[k] += weight * stick[0];
  for (int k = begin; k < end; ++k)
    sum[k] += near * stick[k + offset] + far * stick[k + offset + 1];
  for (int k = end; k < count; ++k) sum[k] += weight * stick[count - 1];
}

/// Sticks of one size in rows, with their edges.
struct StickRows {
  StickRows(int row_count,
            int stick_count,
            int sample_count,
            std::vector<std::vector<float>> memory = {})
      : rows(row_count),
        sticks(stick_count),
        samples(sample_count),
        values(std::move(memory)),
        edges(static_cast<std::size_t>(row_count) * static_cast<std::size_t>(stick_count)) {
    values.resize(static_cast<std::size_t>(rows));
    for (auto& row : values) {
      row.resize(static_cast<std::size_t>(sticks) * static_cast<std::size_t>(samples));
    }
  }
  float* at(int row, int stick) {
    return values[static_cast<std::size_t>(row)].data() + std::ptrdiff_t{stick} * samples;
  }
  double& edge(int row, int stick) { return edges[static_cast<std::size_t>(row * sticks + stick)]; }

  int rows, sticks, samples;
  std::vector<std::vector<float>> values;  ///< [row][stick * samples + sample]
  std::vector<double> edges;               ///< [row * sticks + stick]
};

/// The neighbours at a place; `stick(j)` is the view of the jth.
template <class Stick>
std::array<StickView, 4> neighbours(const FramePlace& place, const Stick& stick) {
  std::array<StickView, 4> views;
  for (std::size_t j = 0; j < 4; ++j) views[j] = stick(place.frames[j]);
  return views;
}

/// Largest difference of edges on one surface, for the edge of either middle stick.
double reach_m(const std::array<StickView, 4>& views,
               double radius_m,
               double step_rad,
               double steepest_rad) {
  const double edge_m = std::isnan(views[1].edge_m) ? views[2].edge_m : views[1].edge_m;
  return std::isnan(edge_m) ? 0 : (radius_m + edge_m) * step_rad * std::tan(steepest_rad);
}

}  // namespace

double mix_sticks(const std::array<StickView, 4>& sticks,
                  double t,
                  double reach_m,
                  double spacing_m,
                  int count,
                  float* mixed) {
  const CommonSurface surface = common_surface(sticks, t, reach_m);
  const std::array<double, 4> weights = b_spline(t);
  std::fill(mixed, mixed + count, 0.0f);
  for (std::size_t j = 0; j < 4; ++j) {
    const double shift = surface.on[j] ? (sticks[j].edge_m - surface.edge_m) / spacing_m : 0;
    add_shifted(sticks[j].samples, shift, static_cast<float>(weights[j]), count, mixed);
  }
  return surface.edge_m;
}

namespace {

/// Where the sticks of dense_plan() lie among the frames: equally spaced, or by their angles.
class DenseFrames {
 public:
  DenseFrames(const hw::AcquisitionPlan& plan,
              const DenseFactors& factors,
              const MotorAngles& angles)
      : plan_(plan), factors_(factors) {
    if (angles.as_planned()) return;
    const int lines = plan.acquisition().sticks_per_frame;
    for (int line = 0; line <= (lines - 1) * factors.lines; ++line) {
      orders_.push_back(angles.order_at(static_cast<double>(line) / factors.lines, lines));
    }
  }

  FramePlace at(int frame, int line) const {
    if (orders_.empty()) {
      return regular_place(
          frame, factors_.frames, plan_.acquisition().frames_per_volume, plan_.phi_step_rad());
    }
    return orders_[static_cast<std::size_t>(line)].at(
        dense_angle_rad(plan_, factors_, frame, line));
  }

 private:
  const hw::AcquisitionPlan& plan_;
  const DenseFactors& factors_;
  std::vector<FrameOrder> orders_;  ///< per line of the denser scan; empty: equally spaced
};

}  // namespace

std::vector<std::vector<float>> align_sticks(const hw::AcquisitionPlan& plan,
                                             const DenseFactors& factors,
                                             const std::vector<std::vector<float>>& frames,
                                             const MotorAngles& angles,
                                             const std::vector<double>& edges,
                                             double steepest_rad,
                                             std::vector<std::vector<float>> memory) {
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const hw::AcquisitionOptions dense = dense_plan(plan, factors).acquisition();
  const int samples = scan.samples_per_stick;
  const double spacing_m = plan.sample_spacing_m();
  const hw::ProbeGeometry geometry = plan.geometry();
  // Mixes the sticks of `views` at a place; the centre of their fan is `radius_m` before the face.
  const auto mix = [&](const std::array<StickView, 4>& views,
                       const FramePlace& place,
                       double radius_m,
                       float* mixed) {
    const double reach = reach_m(views, radius_m, place.step_rad, steepest_rad);
    return mix_sticks(views, place.t, reach, spacing_m, samples, mixed);
  };
  // First between the sticks of each frame, then between frames.
  StickRows lines(scan.frames_per_volume, dense.sticks_per_frame, samples);
  parallel_rows(lines.rows, [&](int frame) {
    const float* sticks = frames[static_cast<std::size_t>(frame)].data();
    const double* frame_edges = edges.data() + std::ptrdiff_t{frame} * scan.sticks_per_frame;
    for (int line = 0; line < lines.sticks; ++line) {
      const FramePlace place =
          regular_place(line, factors.lines, scan.sticks_per_frame, plan.theta_step_rad());
      const auto views = neighbours(place, [&](int l) {
        return StickView{sticks + std::ptrdiff_t{l} * samples, frame_edges[l]};
      });
      lines.edge(frame, line) = mix(views, place, geometry.radius_m(), lines.at(frame, line));
    }
  });
  StickRows all(dense.frames_per_volume, dense.sticks_per_frame, samples, std::move(memory));
  const DenseFrames dense_frames(plan, factors, angles);
  parallel_rows(all.rows, [&](int frame) {
    for (int line = 0; line < all.sticks; ++line) {
      const FramePlace place = dense_frames.at(frame, line);
      const auto views = neighbours(place, [&](int f) {
        return StickView{lines.at(f, line), lines.edge(f, line)};
      });
      mix(views, place, geometry.radius_m() - geometry.axis_z_m(), all.at(frame, line));
    }
  });
  return std::move(all.values);
}

}  // namespace wobblebench::render
