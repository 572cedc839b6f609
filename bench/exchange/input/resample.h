// Sticks from pictures and grids of equal spacing.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "bench/exchange/input/geometry.h"
#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

/// Numbers of sticks and samples that keep the resolution of pixels.
struct StickCounts {
  std::uint64_t samples = 0;
  std::uint64_t lines = 0;
  std::uint64_t frames = 0;  ///< of a grid
};
/// Samples and, at the middle of the depth, sticks lie as near as the pixels, within what a plan
/// allows; or as the geometry says.
StickCounts sticks_of(const Geometry& geometry, double pixel_m);

/// Pictures of the image plane, columns along x, rows into depth.
struct PlanePixels {
  std::uint64_t columns = 0, rows = 0;
  std::array<double, 2> step_m{};  ///< of a column and a row
  glm::dvec2 center{0};            ///< column and row of the centre of curvature
};

/// From a value to a sample, after interpolation.
using ToSample = std::function<double(double value)>;

/// Share of the plan's samples that lie outside the picture.
double share_outside(const hw::AcquisitionPlan& plan, const PlanePixels& pixels);

/// [frame][line][sample], bilinear between `values`, [frame][row][column]; 0 outside.
std::vector<float> sticks_of_planes(const hw::AcquisitionPlan& plan,
                                    const PlanePixels& pixels,
                                    const std::vector<float>& values,
                                    const ToSample& to_sample);

/// Voxels in the probe frame.
struct VoxelGrid {
  std::array<std::uint64_t, 3> sizes{};
  glm::dmat3 step_m{1};    ///< columns: one step along each axis
  glm::dvec3 origin_m{0};  ///< centre of the first voxel

  double least_step_m() const;
};

/// Gives the geometry a fan that sees all of the grid along its third axis, and moves the grid in
/// front of it: the face touches the middle of its near side, and sticks are nearly parallel.
void set_looking_fan(VoxelGrid& grid, Geometry& geometry);

/// [frame][line][sample], trilinear between `values`, [third][second][first]; 0 outside.
std::vector<float> sticks_of_grid(const hw::AcquisitionPlan& plan,
                                  const VoxelGrid& grid,
                                  const std::vector<float>& values,
                                  const ToSample& to_sample);

}  // namespace wobblebench::bench
