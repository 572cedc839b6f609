// Imports closed triangle meshes as level sets.
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
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

void check_volumes(const std::vector<double>& shells) {
  const auto inverted = std::count_if(shells.begin(), shells.end(), [](double v) { return v < 0; });
  if (inverted > 0) {
    throw std::invalid_argument("is turned inside out: " + std::to_string(inverted) + " of " +
                                std::to_string(shells.size()) + " shells have a negative volume");
  }
  if (!(std::accumulate(shells.begin(), shells.end(), 0.0) > 0)) {
    throw std::invalid_argument("encloses no volume");
  }
}

// Peak memory of the conversion. Measured: 28 to 32 bytes per voxel of the band (10 of them
// remain), for balls of 100 to 200 mm and cubes of 200 mm at voxels of 0.125 to 0.5 mm.
double estimated_bytes(const TriangleMesh& mesh, double voxel_m) {
  const double band_voxels = 2 * kHalfWidthVoxels * surface_area(mesh) / (voxel_m * voxel_m);
  return 32 * band_voxels;
}

FloatGrid::Ptr level_set_of(const TriangleMesh& mesh, double voxel_m) {
  std::vector<openvdb::Vec3s> points;
  for (const glm::dvec3& v : mesh.vertices) points.emplace_back(v.x, v.y, v.z);
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto transform = openvdb::math::Transform::createLinearTransform(voxel_m);
  return openvdb::tools::meshToLevelSet<FloatGrid>(
      *transform, points, triangles, float(kHalfWidthVoxels));
}

// A level set keeps only the outermost surface: where surfaces cross themselves or lie within one
// another, its volume differs from that of the triangles.
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
  if (mesh.triangles.empty()) throw std::invalid_argument("has no triangle of any area");
  center(mesh, options.unit_m);
  check_edges(edge_faults(mesh));
  const std::vector<double> shells = shell_volumes(mesh);
  check_volumes(shells);
  check_size(bounds(mesh), options.voxel_m);
  check_bytes(estimated_bytes(mesh, options.voxel_m), ": voxel_mm must be larger");
  const auto grid = level_set_of(mesh, options.voxel_m);
  check_enclosed(*grid, std::accumulate(shells.begin(), shells.end(), 0.0), surface_area(mesh));
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
