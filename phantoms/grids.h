// The OpenVDB side of a phantom. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// Signed distances in metres (negative inside), world space = phantom frame in metres, in the
/// order of Phantom::surfaces(); narrow band, outside it signed background and flooded tiles.
struct Grids {
  std::vector<openvdb::FloatGrid::ConstPtr> signed_distance;
};

}  // namespace wobblebench::phantoms
