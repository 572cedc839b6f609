// Whether a PLY is whole. Assimp 5.2 reads on behind the end of one that is cut short.
#pragma once

#include <filesystem>

namespace wobblebench::phantoms {

/// Walks through the file as its header describes it. Throws std::invalid_argument with one line
/// for a header or a body that ends too early, a word that is no number, a face of less than three
/// corners, and corners that are no vertices.
void check_ply(const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
