// What the calibration phantoms share.
#pragma once

#include <openvdb/openvdb.h>

#include <memory>
#include <utility>

#include "phantoms/grids.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// 70 mm below the face of the default probe, whose centre of curvature is 40 mm behind its face.
inline constexpr glm::dvec3 kCalibrationPosition{0, 0, 110e-3};

/// All boxes of interest are of one depth, so that a picture's step along the ray, and with it what
/// a threshold means, is the same for each.
inline constexpr double kBoxDepth_m = 60e-3;

inline Box cube(double half_m) {
  return {glm::dvec3(-half_m), glm::dvec3(half_m)};
}

/// A box of interest of the usual depth about the axis, its front at `front_m`.
inline Box box_from(double front_m, double half_width_m) {
  return {{-half_width_m, -half_width_m, front_m},
          {half_width_m, half_width_m, front_m + kBoxDepth_m}};
}

inline std::shared_ptr<const Grids> only(openvdb::FloatGrid::ConstPtr grid) {
  auto grids = std::make_shared<Grids>();
  grids->signed_distance = {std::move(grid)};
  return grids;
}

}  // namespace wobblebench::phantoms
