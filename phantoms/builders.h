// The phantoms by name, one function each: built in, and imported from files. Options are checked
// by make_phantom().
#pragma once

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// A fetus of 20 to 34 weeks facing the probe, in amniotic fluid behind the uterine wall.
Phantom make_fetal_face(const PhantomOptions& options);

/// A slab of tissue in fluid. Its front face is the plane through the origin whose normal is -z
/// rotated by tilt_x_rad about x, then by tilt_y_rad about y.
Phantom make_plane(const PhantomOptions& options);

/// Stairs of tissue in fluid: treads normal to z, of equal width over kStairs_m about x = 0; the
/// outer ones extend beyond the field. The first, at -x, lies at z = 0; each next one is closer to
/// the probe by its height in step_heights_m.
Phantom make_steps(const PhantomOptions& options);
inline constexpr double kStairs_m = 66e-3;
/// Largest total height and largest number of steps.
inline constexpr double kHighestStairs_m = 80e-3;
inline constexpr int kMostSteps = 20;

/// A ball of tissue about the origin, in fluid.
Phantom make_sphere(const PhantomOptions& options);

/// Points of equal echo in a homogeneous medium, as the threads of a resolution phantom. Suggested
/// position: the origin in the middle of the default probe's face, where they lie at
/// point_targets().
Phantom make_points(const PhantomOptions& options);

/// A target in the default probe's polar coordinates. Targets lie on the axis at ranges of 20, 30 …
/// 150 mm; at 50, 100 and 150 mm at 10, 20 and 30 deg to both sides in the image plane, and at 10
/// and 20 deg of the motor to both sides across it.
struct PointTarget {
  double range_m;
  double theta_rad;
  double phi_rad;
};
std::vector<PointTarget> point_targets();

/// Tissue that fills the field; no target.
Phantom make_speckle_block(const PhantomOptions& options);

/// A ball of fluid about the origin, in tissue that fills the field; shows enhancement behind it.
Phantom make_cyst(const PhantomOptions& options);

/// A square plate of bone in tissue that fills the field, 30 mm wide, thickness_m thick, its front
/// face tilted as that of make_plane(); casts a shadow. No target.
Phantom make_bone_plate(const PhantomOptions& options);

// The origin of an imported phantom is the centre of the surfaces' axis-aligned bounding box; its
// axes are those of the file; phantoms/framing.h says where it lies before the probe.

/// A closed triangle mesh (.obj, .stl, .ply by Assimp; all meshes of the file together) as one
/// surface. Throws InvalidPhantom "file = "PATH": reason" for a file that is not readable, has no
/// triangles or values that are not finite, is not closed, is oriented inconsistently or inside
/// out, intersects itself, is smaller than 4 voxels or larger than 500 mm, or would take more than
/// 4 GB of memory.
Phantom make_mesh(const PhantomOptions& options);

/// Float level sets of an OpenVDB file, all with the same voxels. Throws InvalidPhantom for grids
/// that are not readable, empty, not finite, of another type or class, without cubic voxels, not
/// distances, too small or too large, and for names missing in the file or the material table.
Phantom make_vdb(const PhantomOptions& options);

}  // namespace wobblebench::phantoms
