// Showing a page to the person at the machine.
#pragma once

#include <filesystem>

namespace wobblebench::bench {

/// Starts xdg-open with the file and does not wait for it. Where that cannot be started, one line
/// on stderr says so: the command has done its work.
void open_in_browser(const std::filesystem::path& page);

}  // namespace wobblebench::bench
