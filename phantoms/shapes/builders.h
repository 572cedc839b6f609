// The phantoms by name, one function each. Options are checked by make_phantom.
#pragma once

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// A fetus of 20 to 30 weeks, facing the probe, in its fluid behind the uterine wall.
Phantom make_fetal_face(const PhantomOptions& options);

/// A slab of tissue in fluid; its front face is the plane through the origin whose normal is
/// -z turned by tilt_x_rad, then by tilt_y_rad.
Phantom make_plane(const PhantomOptions& options);

/// Stairs of tissue in fluid: treads across z, equally wide over kStairs_m about x = 0, the outer
/// ones reaching on beyond the field. The first, at -x, lies at z = 0; each next one stands out
/// towards the probe by its height of step_heights_m.
Phantom make_steps(const PhantomOptions& options);
inline constexpr double kStairs_m = 66e-3;
/// The highest that stairs may be in all, and their largest number.
inline constexpr double kHighestStairs_m = 80e-3;
inline constexpr int kMostSteps = 20;

/// A ball of tissue about the origin, in fluid.
Phantom make_sphere(const PhantomOptions& options);

/// Small balls at three depths in fluid, as of a wire phantom.
Phantom make_points(const PhantomOptions& options);

/// Tissue that fills the field: no target.
Phantom make_speckle_block(const PhantomOptions& options);

/// A ball of fluid about the origin, in tissue that fills the field: enhancement behind it.
Phantom make_cyst(const PhantomOptions& options);

/// A square plate of bone in tissue that fills the field, 30 mm wide, thickness_m thick, its front
/// face tilted as that of make_plane: a shadow behind it. No target.
Phantom make_bone_plate(const PhantomOptions& options);

}  // namespace wobblebench::phantoms
