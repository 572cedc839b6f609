// A check of PLY files before Assimp 5.2 reads them: it reads past the end of a truncated one.
#pragma once

#include <filesystem>

namespace wobblebench::phantoms {

/// Parses the file as its header describes it. Throws std::invalid_argument with one line for a
/// truncated header or body, an element of more than 100 properties, a word that is no number, a
/// face of fewer than three corners, or a vertex index out of range.
void check_ply(const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
