// How deep a TOML text nests, before it is parsed: toml++ parses and frees dotted keys recursively.
#pragma once

#include <optional>
#include <string_view>

namespace wobblebench::bench {

/// Far above any scene's, far below what a stack holds.
inline constexpr int kDeepestToml = 32;

/// The first line on which brackets, or the parts of a dotted key, nest deeper than kDeepestToml;
/// nullopt if there is none. The text need not be valid.
std::optional<int> line_nested_too_deep(std::string_view toml);

}  // namespace wobblebench::bench
