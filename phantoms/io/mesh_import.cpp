// Imports closed triangle meshes as level sets.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Composite.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "base/text.h"
#include "phantoms/builders.h"
#include "phantoms/float_grid.h"
#include "phantoms/framing.h"
#include "phantoms/grids.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"
#include "phantoms/io/triangle_mesh.h"
#include "phantoms/refusal.h"
#include "phantoms/shapes/level_set.h"

namespace wobblebench::phantoms {
namespace {

void check_edges(const EdgeFaults& faults) {
  if (faults.open + faults.crowded > 0) {
    throw std::invalid_argument(
        "is not a closed surface: " + std::to_string(faults.open + faults.crowded) +
        " edges are not shared by exactly two triangles");
  }
  if (faults.opposite > 0) {
    throw std::invalid_argument("has triangles that face opposite ways at " +
                                std::to_string(faults.opposite) + " edges");
  }
}

// A surface within a body bounds a cavity, and one within a cavity another body.
void check_shells(const std::vector<Shell>& shells) {
  const auto shown = [&](std::ptrdiff_t count) {
    return std::to_string(count) + " of " + std::to_string(shells.size()) + " shells ";
  };
  const auto inverted = std::ranges::count_if(
      shells, [](const Shell& shell) { return shell.depth % 2 == 0 && shell.volume < 0; });
  if (inverted > 0) {
    throw std::invalid_argument("is turned inside out: " + shown(inverted) +
                                "have a negative volume");
  }
  const auto nested = std::ranges::count_if(
      shells, [](const Shell& shell) { return shell.depth % 2 == 1 && shell.volume > 0; });
  if (nested > 0) {
    throw std::invalid_argument(shown(nested) +
                                "lie within another and face outwards as it does: turn them "
                                "inwards for a cavity; for bodies of several materials use the "
                                "level sets of a .vdb");
  }
  if (!(enclosed_volume(shells) > 0)) throw std::invalid_argument("encloses no volume");
}

// Peak memory of the conversion. Measured: 28 to 32 bytes per voxel of the band (10 of them
// remain), for balls of 100 to 200 mm and cubes of 200 mm at voxels of 0.125 to 0.5 mm.
double estimated_bytes(const TriangleMesh& mesh, double voxel_m) {
  const double band_voxels = 2 * kHalfWidthVoxels * surface_area(mesh) / (voxel_m * voxel_m);
  return 32 * band_voxels;
}

// Of shells that do not lie within one another: OpenVDB keeps the outermost surface alone.
FloatGrid::Ptr level_set_of(const std::vector<openvdb::Vec3s>& points,
                            const std::vector<TriangleMesh::Triangle>& triangles,
                            double voxel_m) {
  std::vector<openvdb::Vec3I> corners;
  for (const auto& t : triangles) corners.emplace_back(t[0], t[1], t[2]);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_m);
  return openvdb::tools::meshToLevelSet<FloatGrid>(
      *transform, points, corners, float(kHalfWidthVoxels));
}

// From the outside in: less the cavities, and with the bodies in them.
FloatGrid::Ptr level_set_of(const TriangleMesh& mesh,
                            const std::vector<Shell>& shells,
                            double voxel_m) {
  std::vector<openvdb::Vec3s> points;
  for (const glm::dvec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
  const int deepest = std::ranges::max(shells, {}, &Shell::depth).depth;
  if (deepest == 0) return level_set_of(points, mesh.triangles, voxel_m);
  std::vector<std::vector<TriangleMesh::Triangle>> layers(static_cast<std::size_t>(deepest) + 1);
  for (const Shell& shell : shells) {
    auto& layer = layers[static_cast<std::size_t>(shell.depth)];
    layer.insert(layer.end(), shell.triangles.begin(), shell.triangles.end());
  }
  auto body = level_set_of(points, layers[0], voxel_m);
  for (std::size_t depth = 1; depth < layers.size(); ++depth) {
    const auto layer = level_set_of(points, layers[depth], voxel_m);
    depth % 2 == 1 ? openvdb::tools::csgDifference(*body, *layer)
                   : openvdb::tools::csgUnion(*body, *layer);
  }
  return body;
}

// Where surfaces cross themselves or each other, the level set's volume differs from that of the
// triangles.
void check_enclosed(const FloatGrid& grid, double volume_m3, double area_m2) {
  const double enclosed = openvdb::tools::levelSetVolume(grid);
  const double allowed = 0.1 * grid.voxelSize()[0] * area_m2;
  if (std::abs(enclosed - volume_m3) <= allowed) return;
  std::ostringstream reason;
  reason << "crosses itself, or has walls thinner than its voxels: its triangles enclose "
         << volume_m3 * 1e6 << " ml, its voxels " << enclosed * 1e6 << " ml";
  throw std::invalid_argument(reason.str());
}

// Scales to metres and moves the centre of the bounding box to the origin.
void center(TriangleMesh& mesh, double unit_m) {
  for (glm::dvec3& vertex : mesh.vertices) vertex *= unit_m;
  const Box box = bounds(mesh);
  for (glm::dvec3& vertex : mesh.vertices) vertex -= 0.5 * (box.low + box.high);
}

std::string surface_name(const std::string& file) {
  const std::string stem = std::filesystem::path(file).stem().string();
  return is_printable_text(stem) ? stem : "mesh";
}

Phantom import_mesh(const PhantomOptions& options) {
  initialize_openvdb();
  TriangleMesh mesh = welded(read_mesh(options.file));
  if (edge_faults(mesh).open > 0) mesh = welded_but_for_rounding(mesh);
  if (mesh.triangles.empty()) throw std::invalid_argument("has no triangle of any area");
  center(mesh, options.unit_m);
  check_edges(edge_faults(mesh));
  const std::vector<Shell> shells = shells_of(mesh);
  check_shells(shells);
  check_size(bounds(mesh), options.voxel_m);
  check_bytes(estimated_bytes(mesh, options.voxel_m), ": voxel_mm must be larger");
  const auto grid = level_set_of(mesh, shells, options.voxel_m);
  check_enclosed(*grid, enclosed_volume(shells), surface_area(mesh));
  const std::string name = surface_name(options.file);
  grid->setName(name);
  return imported_phantom(options,
                          {{name, material_index(options.materials.front()), options.target}},
                          bounds(mesh),
                          single_grid(grid));
}

}  // namespace

Phantom make_mesh(const PhantomOptions& options) {
  try {
    return import_mesh(options);
  } catch (const ImportUnavailable&) {
    throw;
  } catch (const std::exception& error) {
    throw refusal("file", quoted(options.file), error.what());
  }
}

}  // namespace wobblebench::phantoms
