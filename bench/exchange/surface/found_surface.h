// The surface that another program found, as a depth map of a view: from a depth map, a mesh or a
// cloud of points.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "bench/exchange/surface/depth_map_file.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// What a user says of the file; nothing: as the file says, else the default.
struct SurfaceFileOptions {
  std::filesystem::path file;
  std::string unit;           ///< "mm" or "m"; empty: as the file says, else mm
  std::string kind;           ///< of depths: "ray" or "z"; empty: ray
  std::string frame;          ///< of meshes and points: "probe", "phantom" or "file"; empty: probe
  DepthMapChoice depths;      ///< of depth maps
  std::optional<double> far;  ///< depths from this on, in the file's unit, are no surface
  double point_m = 0;         ///< radius of points; 0: of their spacing
  double step_m = 0;          ///< of a map's numbers; 0: they are lengths
};

enum class SurfaceFileKind { depth_map, mesh, points };
const char* to_string(SurfaceFileKind kind);  ///< "point cloud"

struct FoundSurface {
  SurfaceFileKind kind = SurfaceFileKind::depth_map;
  std::string format;    ///< "EXR, channel Z"
  Image<float> depth_m;  ///< as render::Picture::depth_m
  /// What was taken for what the file does not say, or says: "unit": "mm (assumed; …)".
  std::vector<std::pair<std::string, std::string>> taken;
  /// Numbers of vertices, of triangles, of pixels without a surface by their cause.
  std::vector<std::pair<std::string, long>> counts;
};

/// A depth map by the file's first bytes; by its extension .ply, .stl, .obj are meshes, or points
/// where they have no triangles. Throws UserError "FILE: …": one that cannot be
/// read, is damaged, of another size or of another view than the scene's, or of which nothing lies
/// in the view's box, with what may be meant.
FoundSurface read_found_surface(const SurfaceFileOptions& options, const ResolvedScene& scene);

/// Throws std::invalid_argument for depths that lie elsewhere than the view's box, with the unit in
/// which they would not. `unit_m`: of the file; 0: it has no other.
void check_depths(const Image<float>& depth_m, const render::View& view, double unit_m);

/// The depths of a map in the view: see read_found_surface(). `file`: for refusals.
FoundSurface surface_of(const DepthMapFile& map,
                        const SurfaceFileOptions& options,
                        const render::View& view);

}  // namespace wobblebench::bench
