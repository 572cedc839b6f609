// Showing a page to the person at the machine.
#pragma once

#include <filesystem>
#include <string>

namespace wobblebench::bench {

/// Starts xdg-open with the file and does not wait for it. Returns why it cannot be started, as a
/// warning, for the command has done its work; empty: it was.
std::string open_in_browser(const std::filesystem::path& page);
/// The same with an address.
std::string open_address(const std::string& address);

}  // namespace wobblebench::bench
