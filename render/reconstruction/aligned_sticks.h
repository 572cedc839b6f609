// Sticks between the sticks of a scan, mixed at equal distance from their surface.
#pragma once

#include <array>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/geometry/slice_geometry.h"
#include "render/reconstruction/motor_angles.h"

namespace wobblebench::render {

/// One stick of four that are mixed.
struct StickView {
  const float* samples = nullptr;
  double edge_m = 0;  ///< range of its surface; NaN: none found
};

/// Shape-based interpolation (docs/references.md [24]) of the stick at `t` in [0, 1] between the
/// two middle ones of four neighbours. Its edge follows the neighbours' by a Catmull-Rom spline;
/// its samples are their mean with the weights of a cubic B-spline, each read at the same distance
/// from its own edge. A neighbour whose edge is more than `reach_m` from that of the one beside it
/// lies on another surface; it and those without an edge are read at equal depth, so that without
/// edges this is plain interpolation. Writes `count` samples, `spacing_m` apart; returns the edge.
double mix_sticks(const std::array<StickView, 4>& sticks,
                  double t,
                  double reach_m,
                  double spacing_m,
                  int count,
                  float* mixed);

/// The frames of dense_plan(): samples in the order of a frame's. `angles`: of `frames`. `edges`:
/// of find_stick_edges(). `steepest_rad`: the largest slope of one surface between neighbouring
/// sticks. `memory`: frames of before, which are written over: a volume takes 100 MB, and the heap
/// of a stream would grow by pieces between them.
std::vector<std::vector<float>> align_sticks(const hw::AcquisitionPlan& plan,
                                             const DenseFactors& factors,
                                             const std::vector<std::vector<float>>& frames,
                                             const MotorAngles& angles,
                                             const std::vector<double>& edges,
                                             double steepest_rad,
                                             std::vector<std::vector<float>> memory = {});

}  // namespace wobblebench::render
