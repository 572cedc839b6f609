// The built-in phantoms, one function each. Millimetres and ages are checked by make_phantom.
#pragma once

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// A fetus of 20 to 30 weeks, facing the probe, in its fluid behind the uterine wall.
Phantom make_fetal_face(const PhantomOptions& options);

/// A slab of tissue in fluid; its front face is the plane through the origin whose normal is
/// -z turned by tilt_x_rad, then by tilt_y_rad.
Phantom make_plane(const PhantomOptions& options);

/// A ball of tissue about the origin, in fluid.
Phantom make_sphere(const PhantomOptions& options);

/// Small balls at three depths in fluid, as of a wire phantom.
Phantom make_points(const PhantomOptions& options);

/// Tissue that fills the field: no target.
Phantom make_speckle_block(const PhantomOptions& options);

/// Row of `name` in material_table().
MaterialIndex material_index(const std::string& name);

}  // namespace wobblebench::phantoms
