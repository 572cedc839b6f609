// Phantoms made of what other programs wrote. The phantom's origin is the middle of the upright box
// that holds the surfaces; the axes are the file's; the suggested position has the front of that
// box 65 mm below the probe's face.
#pragma once

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// A closed triangle mesh (.obj, .stl, .ply through Assimp; several meshes of a file are taken
/// together) as one surface. Refuses ("file = "PATH": reason") what is not readable, has no
/// triangles or numbers that are not finite, is open, has triangles facing opposite ways or a shell
/// turned inside out, crosses itself, is too small for the voxels or larger than 500 mm, or would
/// take absurd memory.
Phantom make_mesh(const PhantomOptions& options);

/// Float level sets of an OpenVDB file, on one lattice. Refuses what is not readable, empty, not
/// finite, of another type or class, without cubic voxels, not in distances, too small or too
/// large, and names that the file or the material table does not hold.
Phantom make_vdb(const PhantomOptions& options);

/// What write_phantom wrote.
Phantom make_file(const PhantomOptions& options);

/// What can be known before the file is read.
void check_mesh(const PhantomOptions& options);
void check_vdb(const PhantomOptions& options);
void check_file(const PhantomOptions& options);

/// Larger bodies reach beyond any field.
inline constexpr double kLargestBody_m = 500e-3;
/// Smaller ones, in voxels, are lost between them.
inline constexpr int kSmallestBody = 4;
/// Most memory that the grids of an imported phantom may take on their way.
inline constexpr double kMostBytes = 4e9;

/// Throws std::invalid_argument with both figures where a body of this box is too large or too
/// small.
void check_size(const Box& bounds, double voxel_m);

/// Throws std::invalid_argument "would take about … of memory …".
void check_bytes(double bytes, const std::string& advice);

/// The phantom of surfaces within `bounds`, which lie about the origin.
Phantom imported_phantom(const PhantomOptions& options,
                         std::vector<Surface> surfaces,
                         const Box& bounds,
                         std::shared_ptr<const Grids> grids);

}  // namespace wobblebench::phantoms
