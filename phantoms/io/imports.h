// Phantoms from files. The origin of an imported phantom is the centre of the surfaces'
// axis-aligned bounding box; its axes are those of the file; phantoms/framing.h says where it lies
// before the probe.
#pragma once

#include "phantoms/io/memory_limit.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// A closed triangle mesh (.obj, .stl, .ply by Assimp; all meshes of the file together) as one
/// surface. Throws InvalidPhantom "file = "PATH": reason" for a file that is not readable, has no
/// triangles or values that are not finite, is not closed, is oriented inconsistently or inside
/// out, intersects itself, is smaller than kSmallestBody voxels or larger than kLargestBody_m, or
/// would take more memory than kMostBytes.
Phantom make_mesh(const PhantomOptions& options);

/// Float level sets of an OpenVDB file, all with the same voxels. Throws InvalidPhantom for grids
/// that are not readable, empty, not finite, of another type or class, without cubic voxels, not
/// distances, too small or too large, and for names missing in the file or the material table.
Phantom make_vdb(const PhantomOptions& options);

/// A phantom that write_phantom() wrote.
Phantom make_file(const PhantomOptions& options);

/// Checks that do not read the file; throw InvalidPhantom.
void check_mesh(const PhantomOptions& options);
void check_vdb(const PhantomOptions& options);
void check_file(const PhantomOptions& options);
/// Of a material's name; throws InvalidPhantom.
void check_material(const std::string& key, const std::string& name);

/// Larger bodies extend beyond every field.
inline constexpr double kLargestBody_m = 500e-3;
/// Smaller ones, in voxels, are not resolved.
inline constexpr int kSmallestBody = 4;

/// Throws std::invalid_argument, with size and limit, if a body with these bounds is too large or
/// too small.
void check_size(const Box& bounds, double voxel_m);

/// The phantom of surfaces within `bounds`, whose centre is the origin.
Phantom imported_phantom(const PhantomOptions& options,
                         std::vector<Surface> surfaces,
                         const Box& bounds,
                         std::shared_ptr<const Grids> grids);

}  // namespace wobblebench::phantoms
