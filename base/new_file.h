// Files that did not exist before.
#pragma once

#include <filesystem>
#include <string_view>

namespace wobblebench {

/// write_file() to a new file: where there is one of that name, be it a link, it is not written. Of
/// a file that cannot be written whole nothing is left. `folder`: an open descriptor of the path's
/// folder, through which it is reached whatever has that folder's name now; -1: by the path.
void write_new_file(const std::filesystem::path& path, std::string_view bytes, int folder = -1);

}  // namespace wobblebench
