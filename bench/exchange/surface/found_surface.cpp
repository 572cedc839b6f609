#include "bench/exchange/surface/found_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "base/number_text.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/exchange/surface/seen_surface.h"
#include "bench/output/camera_matrices.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::bench {

namespace {

constexpr int kDigits = 4;

std::string mm(double metres) {
  return significant(metres / kMillimetre, kDigits);
}

double unit_of(const std::string& name) {
  return name == "m" ? 1 : kMillimetre;
}

/// The unit of lengths: what the user says, which must be what the file says; else what that says.
std::string unit_name(const SurfaceFileOptions& options,
                      const std::optional<std::string>& in_file,
                      FoundSurface& found) {
  const bool known = in_file && (*in_file == "mm" || *in_file == "m");
  if (known && !options.unit.empty() && options.unit != *in_file) {
    throw UserError("--unit = " + options.unit + ": " + options.file.string() + " says " +
                    *in_file + ": leave it out");
  }
  if (!options.unit.empty()) {
    found.taken.emplace_back("unit", options.unit + " (--unit)");
    return options.unit;
  }
  if (known) {
    found.taken.emplace_back("unit", *in_file + " (the file says so)");
    return *in_file;
  }
  found.taken.emplace_back("unit", "mm (assumed; --unit m otherwise)");
  return "mm";
}

// ---- depth maps

/// Metres of a step of a map's numbers.
double map_unit_m(const SurfaceFileOptions& options, const DepthMapFile& map, FoundSurface& found) {
  if (options.step_m == 0) {
    if (map.format != "PNG") return unit_of(unit_name(options, map.unit, found));
    throw std::invalid_argument(
        "has no unit, as no PNG has: --step-mm must say how many mm a step of its numbers is");
  }
  if (!options.unit.empty()) throw UserError("--unit: must not be given with --step-mm");
  found.taken.emplace_back("unit", mm(options.step_m) + " mm a step (--step-mm)");
  return options.step_m;
}

/// A file that carries its camera must be of this view.
void check_view(const DepthMapFile& map, const render::Camera& camera) {
  constexpr double kAllowed = 1e-3;  // of the picture's width, and of what float32 costs
  if (!map.world_to_ndc) return;
  const RowMatrix wanted = world_to_ndc(camera);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto stored = static_cast<double>((*map.world_to_ndc)[i]);
    if (std::abs(stored - wanted[i]) <= kAllowed * (1 + std::abs(wanted[i]))) continue;
    throw std::invalid_argument(
        "was made for another view than the scene's: its worldToNDC differs; give the report of "
        "its own run, or --set render.view and render.volume_of_interest as there");
  }
}

/// Length along the ray over z of the camera.
double ray_per_z(const render::Camera& camera, int column, int row) {
  return 1 / glm::dot(camera.ray(column, row).direction, camera.forward);
}

enum class Nothing { none, nan, not_positive, masked, far };

Nothing why_nothing(const DepthMapFile& map, std::size_t pixel, const std::optional<double>& far) {
  const double value = map.values[pixel];
  if (!map.mask.empty() && !map.mask[pixel]) return Nothing::masked;
  if (!std::isfinite(value)) return Nothing::nan;
  if (value <= 0) return Nothing::not_positive;
  return far && value >= *far ? Nothing::far : Nothing::none;
}

/// Depths along the ray, m; fills in how many pixels have none, and why.
Image<float> depths_of(const DepthMapFile& map,
                       const SurfaceFileOptions& options,
                       const render::Camera& camera,
                       double unit_m,
                       FoundSurface& found) {
  std::array<long, 5> counts{};
  Image<float> depth_m(map.width, map.height, kNoSurface);
  const bool is_z = options.kind == "z";
  for (int row = 0; row < map.height; ++row) {
    for (int column = 0; column < map.width; ++column) {
      const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) +
                         static_cast<std::size_t>(column);
      const Nothing why = why_nothing(map, pixel, options.far);
      ++counts[static_cast<std::size_t>(why)];
      if (why != Nothing::none) continue;
      const double scale = is_z ? ray_per_z(camera, column, row) : 1;
      depth_m.at(column, row) = static_cast<float>(map.values[pixel] * unit_m * scale);
    }
  }
  const char* names[] = {
      "pixels_found", "pixels_nan", "pixels_zero_or_less", "pixels_masked", "pixels_far"};
  for (std::size_t i = 0; i < counts.size(); ++i) found.counts.emplace_back(names[i], counts[i]);
  return depth_m;
}

void check_any(const FoundSurface& found) {
  if (found.counts.front().second > 0) return;
  std::string causes;
  for (const auto& [name, count] : found.counts) {
    if (count == 0) continue;
    causes += (causes.empty() ? "" : ", ") + std::to_string(count) + " " + name;
  }
  std::ranges::replace(causes, '_', ' ');
  throw std::invalid_argument("holds no surface: " + causes);
}

/// Depths in the box of interest, of all rays.
struct BoxDepths {
  double near_m = INFINITY;
  double far_m = -INFINITY;
};

BoxDepths box_depths(const render::View& view) {
  BoxDepths box;
  for (int row = 0; row < view.camera.image_size; ++row) {
    for (int column = 0; column < view.camera.image_size; ++column) {
      const render::Span span = render::clip_to_box(view.camera.ray(column, row), view.box);
      if (!(span.to_m >= span.from_m)) continue;
      box = {std::min(box.near_m, span.from_m), std::max(box.far_m, span.to_m)};
    }
  }
  return box;
}

double share_within(const std::vector<double>& depths_m, const BoxDepths& box, double scale) {
  const auto within = std::ranges::count_if(depths_m, [&](double depth_m) {
    return depth_m * scale >= box.near_m && depth_m * scale <= box.far_m;
  });
  return static_cast<double>(within) / static_cast<double>(depths_m.size());
}

std::vector<double> finite(const Image<float>& depth_m) {
  std::vector<double> depths_m;
  for (const float depth : depth_m.pixels) {
    if (!std::isnan(depth)) depths_m.push_back(static_cast<double>(depth));
  }
  return depths_m;
}

/// A unit that would put the lengths, now read by `unit_m`, where they belong; empty: none would.
std::string hint_of_unit(double unit_m, const std::function<bool(double)>& fits) {
  if (unit_m < 1 && fits(1 / kMillimetre)) return "; in metres they would fit: --unit m";
  if (unit_m == 1 && fits(kMillimetre)) return "; in millimetres they would fit: --unit mm";
  return "";
}

/// Many pixels at one depth behind everything are a background, of which the user must say so.
void check_background(const Image<float>& depth_m, const render::View& view, double unit_m) {
  constexpr double kLeastShare = 0.001;
  const std::vector<double> depths_m = finite(depth_m);
  const double most_m = std::ranges::max(depths_m);
  const auto count = std::ranges::count(depths_m, most_m);
  const auto pixels = static_cast<double>(depth_m.pixels.size());
  if (most_m <= box_depths(view).far_m || static_cast<double>(count) < kLeastShare * pixels) return;
  throw std::invalid_argument(std::to_string(count) + " of its pixels have the same depth, " +
                              mm(most_m) +
                              " mm, behind the view's box: where that means no surface, "
                              "give --far " +
                              significant(most_m / unit_m, 6));
}

// ---- meshes and points

struct Extent {
  glm::dvec3 low{INFINITY}, high{-INFINITY};
};

Extent extent_of(const std::vector<glm::dvec3>& points) {
  Extent extent;
  for (const glm::dvec3& point : points) {
    extent = {glm::min(extent.low, point), glm::max(extent.high, point)};
  }
  return extent;
}

std::string text_of(const Extent& extent) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    text += (axis == 0 ? "" : ", ") + std::string(1, "xyz"[axis]) + " " + mm(extent.low[axis]) +
            " to " + mm(extent.high[axis]);
  }
  return text + " mm";
}

/// Whether two boxes overlap and neither is more than ten times as long as the other.
bool alike(const Extent& a, const Extent& b) {
  double longest_a = 0, longest_b = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (a.low[axis] > b.high[axis] || b.low[axis] > a.high[axis]) return false;
    longest_a = std::max(longest_a, a.high[axis] - a.low[axis]);
    longest_b = std::max(longest_b, b.high[axis] - b.low[axis]);
  }
  return longest_a <= 10 * longest_b && longest_b <= 10 * longest_a;
}

using ToProbe = std::function<glm::dvec3(const glm::dvec3&)>;

/// From the frame of the file's coordinates, in m, to the probe frame.
ToProbe to_probe_of(const SurfaceFileOptions& options, const ResolvedScene& scene) {
  const phantoms::PhantomOptions& phantom = scene.options().phantom;
  if (options.frame.empty() || options.frame == "probe") {
    return [](const glm::dvec3& at_m) { return at_m; };
  }
  glm::dvec3 origin_m{0};  // of the phantom's frame, in the file's
  if (options.frame == "file") {
    if (phantom.name != "mesh") {
      throw UserError(
          "--frame = file: needs a phantom that a mesh was imported for; phantom.name = " +
          phantom.name);
    }
    const phantoms::Box box = bounds(welded(phantoms::read_mesh(phantom.file)));
    origin_m = 0.5 * phantom.unit_m * (box.low + box.high);
  }
  return [placement = scene.subject()->placement, origin_m](const glm::dvec3& at_m) {
    return placement.to_probe(at_m - origin_m);
  };
}

/// The frame, and how it was chosen.
std::string frame_text(const SurfaceFileOptions& options, const ResolvedScene& scene) {
  if (options.frame.empty()) return "probe (assumed; --frame phantom otherwise)";
  std::string text = options.frame + " (--frame)";
  if (options.frame == "phantom" && scene.options().phantom.name == "mesh") {
    text +=
        ", whose origin is the middle of the imported mesh's bounding box (--frame file: as "
        "the mesh has it)";
  }
  return text;
}

/// Why nothing of it is seen.
std::string nothing_in_box(const SurfaceFileOptions& options,
                           const std::vector<glm::dvec3>& in_file,
                           const ToProbe& to_probe,
                           const ResolvedScene& scene,
                           double unit_m) {
  const auto placed = [&](double scale) {
    std::vector<glm::dvec3> points;
    points.reserve(in_file.size());
    for (const glm::dvec3& point : in_file) {
      points.push_back(to_probe(scale * unit_m * point));
    }
    return extent_of(points);
  };
  const auto& [center_m, size_m] = scene.view().box;
  const Extent box{center_m - 0.5 * size_m, center_m + 0.5 * size_m};
  std::string hint = hint_of_unit(unit_m, [&](double scale) { return alike(placed(scale), box); });
  if (hint.empty() && (options.frame.empty() || options.frame == "probe")) {
    hint = "; a surface in the phantom's frame needs --frame phantom";
  }
  return "no pixel of the view sees it: in the probe frame it lies at " + text_of(placed(1)) +
         ", the view's box at " + text_of(box) + hint;
}

Image<float> seen_points(const std::vector<glm::dvec3>& points_m,
                         const SurfaceFileOptions& options,
                         const render::View& view,
                         FoundSurface& found) {
  double radius_m = options.point_m;
  const auto inside = points_in_box(points_m, view);
  found.counts.emplace_back("points_in_box", static_cast<long>(inside.size()));
  if (inside.empty()) return {view.camera.image_size, view.camera.image_size, kNoSurface};
  if (radius_m == 0) radius_m = point_spacing_m(inside);
  if (!(radius_m > 0)) {
    throw std::invalid_argument(
        "has one point in the view's box; --point-mm must say how large it is");
  }
  found.taken.emplace_back("points",
                           "discs of radius " + mm(radius_m) +
                               (options.point_m > 0 ? " mm (--point-mm)"
                                                    : " mm, the P95 of the distance to the next "
                                                      "point (assumed; --point-mm otherwise)"));
  return depth_of_points(inside, view, radius_m);
}

FoundSurface surface_of_mesh(const SurfaceFileOptions& options, const ResolvedScene& scene) {
  FoundSurface found;
  phantoms::TriangleMesh mesh = phantoms::read_mesh_or_points(options.file);
  // An organised cloud has a point for each pixel: NaN where nothing was seen.
  const auto left_out = std::erase_if(
      mesh.vertices, [](const glm::dvec3& at) { return !std::isfinite(at.x + at.y + at.z); });
  const bool is_mesh = !mesh.triangles.empty();
  found.kind = is_mesh ? SurfaceFileKind::mesh : SurfaceFileKind::points;
  found.format = phantoms::lower_case_extension(options.file).substr(1);
  const double unit_m = unit_of(unit_name(options, std::nullopt, found));
  const ToProbe to_probe = to_probe_of(options, scene);
  found.taken.emplace_back("frame", frame_text(options, scene));
  found.counts.emplace_back("vertices", static_cast<long>(mesh.vertices.size()));
  found.counts.emplace_back("triangles", static_cast<long>(mesh.triangles.size()));
  found.counts.emplace_back("points_without_place", static_cast<long>(left_out));
  const std::vector<glm::dvec3> in_file = mesh.vertices;
  for (glm::dvec3& vertex : mesh.vertices) vertex = to_probe(unit_m * vertex);
  found.depth_m = is_mesh ? depth_of_mesh(mesh, scene.view())
                          : seen_points(mesh.vertices, options, scene.view(), found);
  if (finite(found.depth_m).empty()) {
    throw std::invalid_argument(nothing_in_box(options, in_file, to_probe, scene, unit_m));
  }
  return found;
}

std::string format_of(const DepthMapFile& map) {
  return map.channel.empty()
             ? map.format
             : map.format + (map.format == "npz" ? ", array " : ", channel ") + map.channel;
}

}  // namespace

void check_depths(const Image<float>& depth_m, const render::View& view, double unit_m) {
  constexpr double kLeastShare = 0.05;
  const std::vector<double> depths_m = finite(depth_m);
  const BoxDepths box = box_depths(view);
  if (depths_m.empty() || share_within(depths_m, box, 1) >= kLeastShare) return;
  const auto [least, most] = std::ranges::minmax(depths_m);
  throw std::invalid_argument(
      "its depths go from " + mm(least) + " to " + mm(most) +
      " mm, and less than 5 % of them lie in the view's box, " + mm(box.near_m) + " to " +
      mm(box.far_m) + " mm from the camera" +
      hint_of_unit(unit_m, [&](double scale) { return share_within(depths_m, box, scale) > 0.5; }));
}

const char* to_string(SurfaceFileKind kind) {
  return kind == SurfaceFileKind::depth_map ? "depth map"
         : kind == SurfaceFileKind::mesh    ? "mesh"
                                            : "point cloud";
}

FoundSurface surface_of(const DepthMapFile& map,
                        const SurfaceFileOptions& options,
                        const render::View& view) {
  check_map_size(map.width, map.height, view.camera.image_size);
  check_view(map, view.camera);
  FoundSurface found{.kind = SurfaceFileKind::depth_map,
                     .format = format_of(map),
                     .depth_m = {},
                     .taken = {},
                     .counts = {}};
  const double unit_m = map_unit_m(options, map, found);
  found.taken.emplace_back("depth",
                           options.kind.empty()
                               ? "length of the pixel's ray (assumed; --kind z otherwise)"
                           : options.kind == "z" ? "z of the camera (--kind)"
                                                 : "length of the pixel's ray (--kind)");
  found.depth_m = depths_of(map, options, view.camera, unit_m, found);
  check_any(found);
  check_background(found.depth_m, view, unit_m);
  check_depths(found.depth_m, view, unit_m);
  return found;
}

FoundSurface read_found_surface(const SurfaceFileOptions& options, const ResolvedScene& scene) {
  try {
    if (!depth_map_format(options.file).empty()) {
      DepthMapChoice depths = options.depths;
      depths.size = scene.view().camera.image_size;
      return surface_of(read_depth_map(options.file, depths), options, scene.view());
    }
    const std::string extension = phantoms::lower_case_extension(options.file);
    if (extension == ".ply" || extension == ".stl" || extension == ".obj") {
      return surface_of_mesh(options, scene);
    }
  } catch (const std::invalid_argument& error) {
    throw UserError(options.file.string() + ": " + error.what());
  }
  throw UserError(
      options.file.string() +
      ": must be a depth map (.exr, .tif, .tiff, .png, .pfm, .npy, .npz), or a mesh or a point "
      "cloud (.ply, .stl, .obj)");
}

}  // namespace wobblebench::bench
