#include "bench/evaluation/error_model/pixel_terms.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "base/parallel.h"
#include "hw/probe/beam_width.h"
#include "render/camera.h"
#include "render/geometry/ray_sampling.h"
#include "render/passes/surface_depth.h"
#include "sim/optics/beam_profile.h"

namespace wobblebench::bench {

namespace {

constexpr double kMiddleRange_m = 75e-3;
/// Samples this near the surface belong to its edge, not to either side.
constexpr double kEdge_m = 0.5e-3;
constexpr int kLeastPlanePixels = 6;

constexpr double kMostBump_mm = 1;

/// A plane through z within a window: its slopes, per pixel, and how much deeper it is than z in
/// the middle.
struct Slopes {
  double across = 0;
  double down = 0;
  double behind = 0;
};

/// Least squares of a plane through the depths about a pixel.
std::optional<Slopes> fit_plane(const Image<float>& depth_m, int column, int row, int reach) {
  double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  const double z0 = static_cast<double>(depth_m.at(column, row));
  for (int j = std::max(0, row - reach); j <= std::min(depth_m.height - 1, row + reach); ++j) {
    for (int i = std::max(0, column - reach); i <= std::min(depth_m.width - 1, column + reach);
         ++i) {
      const double here = static_cast<double>(depth_m.at(i, j)) - z0;
      if (!std::isfinite(here)) continue;
      const double u = i - column, v = j - row;
      n += 1, x += u, y += v, z += here;
      xx += u * u, xy += u * v, yy += v * v, xz += u * here, yz += v * here;
    }
  }
  if (n < kLeastPlanePixels) return {};
  xx -= x * x / n, xy -= x * y / n, yy -= y * y / n, xz -= x * z / n, yz -= y * z / n;
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-9 * xx * yy)) return {};
  const double across = (xz * yy - yz * xy) / determinant;
  const double down = (yz * xx - xz * xy) / determinant;
  return Slopes{across, down, (z - across * x - down * y) / n};
}

/// Unit vectors of a stick: along it, and the directions in which lines and frames follow.
struct StickAxes {
  glm::dvec3 along, lateral, elevation;
};

StickAxes axes_of(const hw::PolarPoint& p) {
  const double st = std::sin(p.theta_rad), ct = std::cos(p.theta_rad);
  const double sp = std::sin(p.phi_rad), cp = std::cos(p.phi_rad);
  return {{st, -ct * sp, ct * cp}, {ct, st * sp, -st * cp}, {0, -cp, -sp}};
}

/// Index about which to interpolate, and the share of the next.
struct Place {
  int first;
  int second;
  double share;
};

Place place_of(double angle_rad, double step_rad, int count) {
  const double at = step_rad > 0 ? angle_rad / step_rad + 0.5 * (count - 1) : 0;
  const double inside = std::clamp(at, 0.0, count - 1.0);
  const int first = static_cast<int>(inside);
  return {first, std::min(first + 1, count - 1), inside - first};
}

/// Mean of a stick's samples between two ranges.
double mean_between(
    const hw::PolarVolume& volume, int frame, int line, double from_m, double to_m) {
  const auto& plan = volume.plan();
  const int count = plan.acquisition().samples_per_stick;
  const int first = std::clamp(static_cast<int>(from_m / plan.sample_spacing_m()), 0, count - 1);
  const int last = std::clamp(static_cast<int>(to_m / plan.sample_spacing_m()), first, count - 1);
  const float* stick = volume.frame(frame).samples.data() +
                       static_cast<std::size_t>(line) * static_cast<std::size_t>(count);
  double sum = 0;
  for (int k = first; k <= last; ++k) sum += static_cast<double>(stick[k]);
  return sum / (last - first + 1);
}

/// Of the four sticks about a point.
double contrast_at(const hw::PolarVolume& volume, const hw::PolarPoint& p) {
  const auto& plan = volume.plan();
  const auto& scan = plan.acquisition();
  const Place line = place_of(p.theta_rad, plan.theta_step_rad(), scan.sticks_per_frame);
  const Place frame = place_of(p.phi_rad, plan.phi_step_rad(), scan.frames_per_volume);
  const auto of_stick = [&](int f, int l) {
    return mean_between(volume, f, l, p.range_m + kEdge_m, p.range_m + kContrastReach_m) -
           mean_between(volume, f, l, p.range_m - kContrastReach_m, p.range_m - kEdge_m);
  };
  const auto of_frame = [&](int f) {
    return (1 - line.share) * of_stick(f, line.first) + line.share * of_stick(f, line.second);
  };
  return (1 - frame.share) * of_frame(frame.first) + frame.share * of_frame(frame.second);
}

}  // namespace

const std::array<TermDescription, kErrorTerms>& error_terms() {
  static const std::array<TermDescription, kErrorTerms> terms = {{
      {"constant", "mm", "offset of the detector on a surface across the stick"},
      {"buffer", "mm/mm", "buffer length x step: how early a mean of n samples sees an edge"},
      {"lateral_beam",
       "mm/mm",
       "lateral beam width x sin(incidence): the nearer flank echoes first"},
      {"elevation_beam", "mm/mm", "elevation beam width x sin(incidence)"},
      {"line_spacing", "mm/mm", "line spacing x sin(incidence): two lines mixed at equal depth"},
      {"frame_spacing", "mm/mm", "frame spacing x sin(incidence): two frames mixed at equal depth"},
      {"contrast",
       "mm",
       "samples behind less before the surface: before a weak rise the edge is yet to come"},
      {"depth", "mm/mm", "range less 75 mm"},
      {"incidence_correction",
       "mm/mm",
       "the renderer's correction, length x tan(incidence): that it is too long"},
      {"weak_edge",
       "mm/mm",
       "beam width x sin(incidence) x what the contrast lacks: a weaker echo is crossed later"},
      {"bump", "mm/mm", "what stands out of a plane of 8 mm: averaging between sticks flattens it"},
  }};
  return terms;
}

struct TermMeter::State {
  hw::AcquisitionPlan plan;
  sim::BeamProfile beam;
  render::Camera camera;
  double buffer_mm;
  hw::BeamWidths widths;  ///< by which the renderer corrects
  render::RayCastingOptions ray_casting;

  int reach(double length_m) const {
    return std::max(1, static_cast<int>(std::lround(length_m / camera.pixel_m())));
  }

  double bump_mm(const Image<float>& depth_m, int column, int row) const {
    const auto plane = fit_plane(depth_m, column, row, reach(kBumpReach_m));
    return plane ? std::clamp(plane->behind / kMillimetre, -kMostBump_mm, kMostBump_mm) : 0;
  }

  std::optional<glm::dvec3> normal(const Image<float>& depth_m, int column, int row) const {
    const auto slopes = fit_plane(depth_m, column, row, reach(kNormalReach_m));
    if (!slopes) return {};
    const double z = static_cast<double>(depth_m.at(column, row));
    const glm::dvec3 here = camera.ray(column, row).at(z);
    const glm::dvec3 across = camera.ray(column + 1, row).at(z + slopes->across) - here;
    const glm::dvec3 down = camera.ray(column, row + 1).at(z + slopes->down) - here;
    return glm::normalize(glm::cross(across, down));
  }

  PixelTerms measure(const Image<float>& depth_m,
                     const hw::PolarVolume& volume,
                     int column,
                     int row) const {
    PixelTerms terms;
    const double z = static_cast<double>(depth_m.at(column, row));
    if (!std::isfinite(z)) return terms;
    terms.measured = true;
    const hw::Ray ray = camera.ray(column, row);
    const hw::PolarPoint p = plan.geometry().to_polar(ray.at(z));
    const StickAxes axes = axes_of(p);
    const glm::dvec3 n = normal(depth_m, column, row).value_or(axes.along);
    const double sin_lateral = std::abs(glm::dot(n, axes.lateral));
    const double sin_elevation = std::abs(glm::dot(n, axes.elevation));
    const double range_m = std::clamp(p.range_m, 0.0, plan.acquisition().depth_m);
    const double line_m = (plan.geometry().radius_m() + range_m) * plan.theta_step_rad();
    const double frame_m = (plan.geometry().wobble_radius_m() + range_m) * plan.phi_step_rad();
    const auto set = [&](ErrorTerm term, double value) {
      terms.x[static_cast<std::size_t>(term)] = static_cast<float>(value);
    };
    set(kConstantTerm, 1);
    set(kBufferTerm, buffer_mm);
    set(kLateralTerm, beam.lateral_fwhm_m(range_m, p.theta_rad) * sin_lateral / kMillimetre);
    set(kElevationTerm, beam.elevation_fwhm_m(range_m) * sin_elevation / kMillimetre);
    set(kLineSpacingTerm, line_m * sin_lateral / kMillimetre);
    set(kFrameSpacingTerm, frame_m * sin_elevation / kMillimetre);
    set(kContrastTerm, std::clamp(contrast_at(volume, p), 0.0, kMostContrast));
    set(kDepthTerm, (range_m - kMiddleRange_m) / kMillimetre);
    const double cos_incidence = std::abs(glm::dot(n, axes.along));
    const double tangent =
        std::sqrt(std::max(0.0, 1 - cos_incidence * cos_incidence)) / std::max(cos_incidence, 1e-3);
    const hw::BeamWidth length = render::correction_length(ray_casting, widths.at(range_m));
    const double length_m =
        std::hypot(length.lateral_m * sin_lateral, length.elevation_m * sin_elevation) /
        std::max(std::hypot(sin_lateral, sin_elevation), 1e-9);
    set(kTangentTerm, length_m / kMillimetre * std::min(tangent, render::kMaxTangent));
    const auto term = [&](ErrorTerm i) {
      return static_cast<double>(terms.x[static_cast<std::size_t>(i)]);
    };
    set(kWeakEdgeTerm,
        std::hypot(term(kLateralTerm), term(kElevationTerm)) *
            (kMostContrast - term(kContrastTerm)));
    set(kBumpTerm, bump_mm(depth_m, column, row));
    terms.incidence_rad = static_cast<float>(std::acos(std::min(1.0, cos_incidence)));
    return terms;
  }
};

TermMeter::TermMeter(const hw::AcquisitionPlan& plan,
                     const sim::SimulationOptions& simulation,
                     const render::RenderOptions& render)
    : state_(new State{plan,
                       sim::BeamProfile(sim::ProbeOptics(plan, simulation)),
                       render::make_camera(render),
                       render.ray_casting.detector == render::Detector::paper
                           ? render::buffer_samples(render) * render::step_m(render) / kMillimetre
                           : 0,
                       hw::BeamWidths(plan),
                       render.ray_casting}) {}

TermMeter::~TermMeter() = default;

Image<PixelTerms> TermMeter::measure(const Image<float>& filtered_depth_m,
                                     const hw::PolarVolume& volume) const {
  Image<PixelTerms> terms(filtered_depth_m.width, filtered_depth_m.height);
  parallel_rows(terms.height, [&](int row) {
    for (int column = 0; column < terms.width; ++column) {
      terms.at(column, row) = state_->measure(filtered_depth_m, volume, column, row);
    }
  });
  return terms;
}

}  // namespace wobblebench::bench
