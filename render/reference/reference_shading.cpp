// Passes 3 and 4 of the reference, and the correction for incidence before them.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "base/parallel.h"
#include "render/geometry/lighting.h"
#include "render/passes/surface_depth.h"
#include "render/reference/reference_passes.h"

namespace wobblebench::render::reference {
namespace {

/// Calls visit(column, row) for the pixels of a window, clipped at the picture's border.
template <class Pixel, class Visit>
void for_each_neighbour(const Image<Pixel>& image, int column, int row, int size, Visit visit) {
  const int half = size / 2;
  for (int j = std::max(row - half, 0); j <= std::min(row + half, image.height - 1); ++j) {
    for (int i = std::max(column - half, 0); i <= std::min(column + half, image.width - 1); ++i) {
      visit(i, j);
    }
  }
}

/// Shades the height map of a camera. Positions and directions are in the probe frame.
class HeightMap {
 public:
  HeightMap(const Image<double>& depth_m,
            const Image<glm::dvec3>& rendered,
            const RenderOptions& options)
      : depth_m_(depth_m), rendered_(rendered), o_(options.shading), camera_(make_camera(options)) {
    for (const double z_m : depth_m.pixels) nearest_m_ = std::min(nearest_m_, z_m);
  }

  glm::dvec3 shaded(int column, int row) const;

 private:
  struct Lighting {
    glm::dvec3 direction;  ///< towards the light
    double distance_m;
  };

  double depth(int column, int row) const {
    const bool in_picture =
        column >= 0 && row >= 0 && column < depth_m_.width && row < depth_m_.height;
    return in_picture ? depth_m_.at(column, row) : kNoSurface;
  }
  glm::dvec3 position(int column, int row, double z_m) const {
    return camera_.ray(column, row).at(z_m);
  }
  glm::dvec3 tangent(int column, int row, int right, int down) const;
  glm::dvec3 normal(int column, int row) const;
  Lighting light_at(const glm::dvec3& from, const glm::dvec3& to_viewer) const;
  bool in_shadow(const glm::dvec3& from, const Lighting& light) const;
  bool is_above_all(const glm::dvec3& direction, double depth_m) const;
  double pixels_per_m(const glm::dvec3& from, const glm::dvec3& direction) const;

  const Image<double>& depth_m_;
  const Image<glm::dvec3>& rendered_;
  const ShadingOptions& o_;
  Camera camera_;
  double nearest_m_ = std::numeric_limits<double>::infinity();  ///< least z of the picture
};

/// Central difference; one-sided where a neighbour is missing, at constant z where both are.
glm::dvec3 HeightMap::tangent(int column, int row, int right, int down) const {
  const double z_m = depth_m_.at(column, row);
  const double before = depth(column - right, row - down),
               after = depth(column + right, row + down);
  const bool isolated = std::isnan(before) && std::isnan(after);
  const bool use_before = isolated || !std::isnan(before),
             use_after = isolated || !std::isnan(after);
  const glm::dvec3 from = use_before ? position(column - right, row - down, isolated ? z_m : before)
                                     : position(column, row, z_m);
  const glm::dvec3 to = use_after ? position(column + right, row + down, isolated ? z_m : after)
                                  : position(column, row, z_m);
  return to - from;
}

glm::dvec3 HeightMap::normal(int column, int row) const {
  const glm::dvec3 away = glm::cross(tangent(column, row, 1, 0), tangent(column, row, 0, 1));
  const double size = glm::length(away);
  // right x down points away from the viewer, but in a mirrored picture towards them.
  if (size > 0) return (camera_.flipped ? away : -away) / size;
  return -camera_.ray(column, row).direction;
}

HeightMap::Lighting HeightMap::light_at(const glm::dvec3& from, const glm::dvec3& to_viewer) const {
  if (o_.light == Light::directional) {
    return {light_direction_in_probe(o_, camera_), std::numeric_limits<double>::infinity()};
  }
  const glm::dvec3 offset = light_position_in_probe_m(o_, camera_) - from;
  const double distance_m = glm::length(offset);
  return {distance_m > 0 ? offset / distance_m : to_viewer, distance_m};
}

/// Derivative of Camera::project() along a unit direction, for the picture's faster axis.
double HeightMap::pixels_per_m(const glm::dvec3& from, const glm::dvec3& direction) const {
  const glm::dvec3 offset = from - camera_.center;
  glm::dvec2 speed(glm::dot(direction, camera_.right), glm::dot(direction, camera_.down));
  if (camera_.projection == Projection::perspective) {
    const glm::dvec2 lateral(glm::dot(offset, camera_.right), glm::dot(offset, camera_.down));
    const double ahead = glm::dot(offset, camera_.forward) + camera_.eye_distance_m;
    speed = (speed * ahead - lateral * glm::dot(direction, camera_.forward)) *
            camera_.eye_distance_m / (ahead * ahead);
  }
  return std::max(std::abs(speed.x), std::abs(speed.y)) / camera_.pixel_m();
}

/// Whether a trace that goes on in this direction lies before the whole surface from here on. A
/// parallel ray's depth along it is linear; in perspective it may grow again.
bool HeightMap::is_above_all(const glm::dvec3& direction, double depth_m) const {
  return camera_.projection == Projection::parallel && glm::dot(direction, camera_.forward) <= 0 &&
         depth_m <= nearest_m_ + o_.shadow_bias_m;
}

/// Shadow trace (Fig. 4) from a surface point towards the light, one pixel of the picture per step.
bool HeightMap::in_shadow(const glm::dvec3& from, const Lighting& light) const {
  const bool parallel = camera_.projection == Projection::parallel;
  const double behind_m = parallel ? camera_.plane_distance_m : camera_.eye_distance_m;
  double travelled_m = 0;
  for (int i = 0; i < max_shadow_steps(camera_.image_size); ++i) {
    const glm::dvec3 last = from + travelled_m * light.direction;
    travelled_m += 1 / std::max(pixels_per_m(last, light.direction), 1e-3);
    if (travelled_m >= light.distance_m) return false;
    const glm::dvec3 here = from + travelled_m * light.direction;
    if (glm::dot(here - camera_.center, camera_.forward) + behind_m <= 0) return false;
    const PicturePoint projected = camera_.project(here);
    const double left = projected.column + 0.5, top = projected.row + 0.5;
    if (left < 0 || top < 0 || left >= depth_m_.width || top >= depth_m_.height) return false;
    const double height_m = depth_m_.at(static_cast<int>(left), static_cast<int>(top));
    if (height_m + o_.shadow_bias_m < projected.depth_m) return true;
    if (is_above_all(light.direction, projected.depth_m)) return false;
  }
  return false;
}

/// Eq. (2), Blinn-Phong.
glm::dvec3 HeightMap::shaded(int column, int row) const {
  const double z_m = depth_m_.at(column, row);
  if (std::isnan(z_m)) return glm::dvec3(0);
  const hw::Ray ray = camera_.ray(column, row);
  const glm::dvec3 surface = ray.at(z_m), to_viewer = -ray.direction;
  const glm::dvec3 surface_normal = normal(column, row);
  const Lighting light = light_at(surface, to_viewer);
  const double facing = glm::dot(surface_normal, light.direction);
  glm::dvec3 base = o_.base_rgb;
  if (o_.base == ShadingBase::rendered) base *= rendered_.at(column, row);
  glm::dvec3 color = base * (o_.ambient + o_.diffuse * std::max(facing, 0.0));
  if (facing > 0) {
    const glm::dvec3 halfway = light.direction + to_viewer;
    const double along = glm::dot(surface_normal, halfway) / std::max(glm::length(halfway), 1e-20);
    color += o_.specular * std::pow(std::max(along, 0.0), o_.shininess);
  }
  if (o_.shadows && in_shadow(surface, light)) color *= o_.shadow_coefficient;
  return glm::min(color, 1.0);
}

/// Linear map of a window of the guided filter (docs/references.md [19]): scale * colour + offset.
struct GuidedWindow {
  double scale = 0;
  glm::dvec3 offset{0};
};

GuidedWindow guided_window(const Image<glm::dvec3>& picture,
                           int column,
                           int row,
                           const SmoothingOptions& options) {
  glm::dvec3 mean(0);
  double count = 0, variance = 0;
  const auto for_window = [&](auto visit) {
    for_each_neighbour(picture, column, row, options.filter_size, visit);
  };
  for_window([&](int i, int j) {
    mean += picture.at(i, j);
    ++count;
  });
  mean /= count;
  for_window([&](int i, int j) {
    const glm::dvec3 change = picture.at(i, j) - mean;
    variance += glm::dot(change, change) / count;
  });
  const double scale = variance / (variance + options.range_sigma * options.range_sigma);
  return {scale, (1 - scale) * mean};
}

Image<glm::dvec3> smooth_guided(const Image<glm::dvec3>& picture, const SmoothingOptions& options) {
  Image<GuidedWindow> windows(picture.width, picture.height);
  Image<glm::dvec3> smoothed(picture.width, picture.height);
  parallel_rows(picture.height, [&](int row) {
    for (int column = 0; column < picture.width; ++column) {
      windows.at(column, row) = guided_window(picture, column, row, options);
    }
  });
  parallel_rows(picture.height, [&](int row) {
    for (int column = 0; column < picture.width; ++column) {
      glm::dvec3 sum(0);
      double count = 0;
      for_each_neighbour(picture, column, row, options.filter_size, [&](int i, int j) {
        const GuidedWindow& window = windows.at(i, j);
        sum += window.scale * picture.at(column, row) + window.offset;
        ++count;
      });
      smoothed.at(column, row) = sum / count;
    }
  });
  return smoothed;
}

double weight(const glm::dvec3& change, int right, int down, const SmoothingOptions& options) {
  if (options.filter == SmoothingFilter::box) return 1;
  const double sigma = bilateral_spatial_sigma(options.filter_size);
  const double offset2 = (right * right + down * down) / (sigma * sigma);
  const double contrast2 = glm::dot(change, change) / (options.range_sigma * options.range_sigma);
  return std::exp(-0.5 * (offset2 + contrast2));
}

/// A point of the filtered surface.
class Surface {
 public:
  Surface(const Image<double>& depth_m, const Camera& camera)
      : depth_m_(depth_m), camera_(camera) {}

  bool has(int column, int row) const {
    return column >= 0 && row >= 0 && column < depth_m_.width && row < depth_m_.height &&
           !std::isnan(depth_m_.at(column, row));
  }
  glm::dvec3 point(int column, int row) const {
    return camera_.ray(column, row).at(depth_m_.at(column, row));
  }
  /// Between the neighbours on both sides, as far as they exist.
  glm::dvec3 tangent(int column, int row, int right, int down) const {
    const auto end = [&](int side) {
      const int c = column + side * right, r = row + side * down;
      return has(c, r) ? point(c, r) : point(column, row);
    };
    return end(1) - end(-1);
  }

 private:
  const Image<double>& depth_m_;
  const Camera& camera_;
};

/// Squares of the sine of incidence in both directions, of a surface with this normal.
struct SquaredSines {
  double lateral, elevation;
};

SquaredSines squared_sines(const hw::ProbeGeometry& geometry,
                           const hw::PolarPoint& at,
                           const glm::dvec3& normal) {
  const glm::dvec3 stick = geometry.stick(at.theta_rad, at.phi_rad).direction;
  // Across the image plane, which contains the sticks of all angles.
  const glm::dvec3 other = geometry.stick(at.theta_rad + 0.1, at.phi_rad).direction;
  const glm::dvec3 elevation = glm::normalize(glm::cross(stick, other));
  const double e = glm::dot(normal, elevation);
  const glm::dvec3 across = glm::cross(normal, stick);
  return {std::max(0.0, glm::dot(across, across) - e * e), e * e};
}

}  // namespace

Image<double> filter_depth(const Image<double>& depth_m, int filter_size) {
  Image<double> filtered(depth_m.width, depth_m.height, kNoSurface);
  parallel_rows(depth_m.height, [&](int row) {
    for (int column = 0; column < depth_m.width; ++column) {
      if (std::isnan(depth_m.at(column, row))) continue;
      double sum = 0, count = 0;
      for_each_neighbour(depth_m, column, row, filter_size, [&](int i, int j) {
        if (std::isnan(depth_m.at(i, j))) return;
        sum += depth_m.at(i, j);
        ++count;
      });
      filtered.at(column, row) = sum / count;
    }
  });
  return filtered;
}

Image<glm::dvec3> shade(const Image<double>& depth_m,
                        const Image<glm::dvec3>& rendered,
                        const RenderOptions& options) {
  const HeightMap map(depth_m, rendered, options);
  Image<glm::dvec3> picture(depth_m.width, depth_m.height);
  parallel_rows(picture.height, [&](int row) {
    for (int column = 0; column < picture.width; ++column) {
      picture.at(column, row) = map.shaded(column, row);
    }
  });
  return picture;
}

Image<glm::dvec3> smooth(const Image<glm::dvec3>& picture, const SmoothingOptions& options) {
  if (options.filter == SmoothingFilter::guided) return smooth_guided(picture, options);
  Image<glm::dvec3> smoothed(picture.width, picture.height);
  parallel_rows(picture.height, [&](int row) {
    for (int column = 0; column < picture.width; ++column) {
      const glm::dvec3 center = picture.at(column, row);
      glm::dvec3 sum(0);
      double total = 0;
      for_each_neighbour(picture, column, row, options.filter_size, [&](int i, int j) {
        const glm::dvec3 change = picture.at(i, j) - center;
        const double w = weight(change, i - column, j - row, options);
        sum += w * change;
        total += w;
      });
      smoothed.at(column, row) = center + sum / total;
    }
  });
  return smoothed;
}

Image<double> correct_incidence(const Image<double>& depth_m,
                                const hw::AcquisitionPlan& plan,
                                const RenderOptions& options) {
  if (!IncidenceCorrection::acts(options)) return depth_m;
  const hw::BeamWidths beam(plan);
  const hw::ProbeGeometry geometry = plan.geometry();
  const Camera camera = make_camera(options);
  const Image<double> filtered = filter_depth(depth_m, normal_window(options));
  const Surface surface(filtered, camera);
  Image<double> corrected = depth_m;
  parallel_rows(depth_m.height, [&](int row) {
    for (int column = 0; column < depth_m.width; ++column) {
      if (!surface.has(column, row)) continue;
      const glm::dvec3 across =
          glm::cross(surface.tangent(column, row, 1, 0), surface.tangent(column, row, 0, 1));
      if (glm::length(across) == 0) continue;
      const glm::dvec3 normal = glm::normalize(across);
      const hw::Ray ray = camera.ray(column, row);
      const hw::PolarPoint at = geometry.to_polar(ray.at(depth_m.at(column, row)));
      const SquaredSines sines2 = squared_sines(geometry, at, normal);
      const double sine = std::sqrt(sines2.lateral + sines2.elevation);
      if (sine == 0) continue;
      const hw::BeamWidth length = correction_length(options.ray_casting, beam.at(at.range_m));
      const double length_m = std::hypot(length.lateral_m * std::sqrt(sines2.lateral),
                                         length.elevation_m * std::sqrt(sines2.elevation)) /
                              sine;
      const double cosine = std::abs(glm::dot(normal, ray.direction));
      corrected.at(column, row) += length_m * std::min(sine / cosine, kMaxTangent);
    }
  });
  return corrected;
}

}  // namespace wobblebench::render::reference
