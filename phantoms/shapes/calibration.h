// Positions, boxes and grids common to the calibration phantoms.
#pragma once

#include <memory>
#include <utility>

#include "phantoms/grids.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// 70 mm below the face of the default probe, whose centre of curvature is 40 mm behind its face.
inline constexpr glm::dvec3 kCalibrationPosition{0, 0, 110e-3};

/// All regions of interest have one depth, so that the renderer's step along the ray, and with it
/// the meaning of a threshold, is the same for each.
inline constexpr double kBoxDepth_m = 60e-3;

inline Box cube(double half_m) {
  return {glm::dvec3(-half_m), glm::dvec3(half_m)};
}

/// A region of interest of kBoxDepth_m about the z axis, its front at z = `front_m`.
inline Box box_from(double front_m, double half_width_m) {
  return {{-half_width_m, -half_width_m, front_m},
          {half_width_m, half_width_m, front_m + kBoxDepth_m}};
}

/// The grids of a phantom with one surface.
inline std::shared_ptr<const Grids> single_grid(std::shared_ptr<const FloatGrid> grid) {
  auto grids = std::make_shared<Grids>();
  grids->signed_distance = {std::move(grid)};
  return grids;
}

}  // namespace wobblebench::phantoms
