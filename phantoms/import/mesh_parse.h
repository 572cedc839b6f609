// Reads a mesh file, by Assimp, into a message. Runs in wobblebench-import only.
#pragma once

#include <filesystem>

#include "phantoms/io/message.h"

namespace wobblebench::phantoms {

/// Vertices (a count, then three doubles each) and triangles (a list of TriangleMesh::Triangle) of
/// all meshes of the file, in its unit; polygons are triangulated, points and lines dropped. Throws
/// std::invalid_argument with one line for a file that is not readable in the format of its
/// extension.
void write_mesh_message(const std::filesystem::path& path, MessageWriter& out);

}  // namespace wobblebench::phantoms
