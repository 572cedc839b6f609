// Showing a page to the person at the machine.
#pragma once

#include <filesystem>
#include <string>

namespace wobblebench::bench {

/// Starts xdg-open with the file and waits a second at most for its end. Returns why it cannot be
/// started, or how it failed, as a warning, for the command has done its work; empty: neither.
std::string open_in_browser(const std::filesystem::path& page);
/// The same with an address.
std::string open_address(const std::string& address);

}  // namespace wobblebench::bench
