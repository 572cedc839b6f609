// The parsers of wobblebench-import: each reads a file of others into a message. Throw
// std::invalid_argument with one line for a file that is not readable.
#pragma once

#include <filesystem>

#include "phantoms/io/message.h"
#include "phantoms/io/triangle_mesh.h"

namespace wobblebench::phantoms {

/// Reads by OpenVDB, without delayed loading: refuses files that are truncated, or would take more
/// than kMostBytes.
void write_vdb_message(const std::filesystem::path& path, MessageWriter& out);

/// Reads an STL in text or binary. Assimp 5.2 refuses files with bytes behind the last triangle.
TriangleMesh read_stl(const std::filesystem::path& path);

/// Reads an STL by read_stl(), others by Assimp: writes vertices (a list of three doubles each) and
/// triangles (a list of TriangleMesh::Triangle) of all meshes of the file, in its unit; polygons
/// are cut by cut_polygon(), points and lines dropped. The extension says the format.
void write_mesh_message(const std::filesystem::path& path, MessageWriter& out);

/// Reads by libhdf5: writes name and values of each dataset of the root group, one-dimensional
/// numbers stored in the file itself. Groups are ignored; any other dataset is refused, and one of
/// more than kMostScattererRows. Only in builds with WOBBLEBENCH_HDF5.
void write_hdf5_message(const std::filesystem::path& path, MessageWriter& out);

/// Reads an HDF5 file of zea (github.com/tue-bmd/zea): writes the path of its image or envelope,
/// its description, and whether the values are bytes, their sizes (volumes, z, x, y, slowest first)
/// and values; then 1 and the same of their coordinates, m, or 0. Only in builds with
/// WOBBLEBENCH_HDF5.
void write_zea_message(const std::filesystem::path& path, MessageWriter& out);

}  // namespace wobblebench::phantoms
