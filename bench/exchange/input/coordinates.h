// Positions that a file gives for each of its voxels: they say where a grid lies, and whether a
// geometry is the file's.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "bench/exchange/files/voxel_file.h"
#include "bench/exchange/input/foreign_array.h"
#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

/// Positions of a volume's voxels, in the order of the file, m.
using Coordinates = std::vector<glm::dvec3>;

/// Origin and directions of the file's axes. Throws UserError "PATH: …" where the positions are not
/// those of a grid of equal steps, within a hundredth of a step.
void place_by(const Coordinates& coordinates, VoxelFile& file);

/// Throws UserError where samples of sticks lie elsewhere than the plan puts them, by more than
/// their distance along a stick. A shift of all of them is none of a scan's: frames of reference
/// differ.
void check_sticks(const Coordinates& coordinates,
                  const ForeignArray& array,
                  const hw::AcquisitionPlan& plan,
                  const std::vector<double>& motor_rad);

/// Throws UserError where steps along the first two axes are others than these, by more than 1 %.
void check_steps(const Coordinates& coordinates,
                 const ForeignArray& array,
                 const std::array<double, 2>& step_m);

}  // namespace wobblebench::bench
