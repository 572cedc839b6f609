// Scripts and styles that every page holds, embedded by cmake/PageAssets.cmake.
#pragma once

#include <string_view>

namespace wobblebench::bench {

/// Text of "page.css", "page.js" (ours) or "charts.js" (Vega-Lite and what it needs, bundled with
/// the licences); empty where the build has no charts.
std::string_view page_asset(std::string_view file);

/// SHA-256 of that text in hexadecimal digits, for the Content-Security-Policy.
std::string_view page_asset_sha256(std::string_view file);

}  // namespace wobblebench::bench
