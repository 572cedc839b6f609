#include "phantoms/surface_mesh.h"

#include <openvdb/tools/GridTransformer.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"

namespace wobblebench::phantoms {

namespace {

FloatGrid::ConstPtr coarse(const FloatGrid::ConstPtr& fine, double edges) {
  const openvdb::CoordBBox box = fine->evalActiveVoxelBoundingBox();
  if (box.empty()) return fine;
  const double voxel_m = fine->voxelSize().x();
  const double longest_m = voxel_m * box.dim()[static_cast<int>(box.maxExtent())];
  const double cube_m = longest_m / edges;
  if (cube_m <= voxel_m) return fine;
  FloatGrid::Ptr grid = create_level_set(cube_m, 3 * cube_m);
  openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*fine, *grid);
  return grid;
}

}  // namespace

SurfaceMesh surface_mesh(const Phantom& phantom, std::size_t surface, double edges) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(
      *coarse(phantom.grids().signed_distance.at(surface), edges), points, triangles, quads);
  SurfaceMesh mesh;
  for (const openvdb::Vec3s& point : points)
    mesh.points_m.emplace_back(point.x(), point.y(), point.z());
  for (const openvdb::Vec3I& corners : triangles) {
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  for (const openvdb::Vec4I& corners : quads) {
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
    mesh.triangles.push_back({corners[0], corners[2], corners[3]});
  }
  return mesh;
}

}  // namespace wobblebench::phantoms
