#include "bench/scene/toml_file.h"

#include <cstddef>
#include <system_error>

#include "base/file.h"
#include "base/user_error.h"
#include "bench/scene/toml_depth.h"

namespace wobblebench::bench {

namespace {

void check_is_file(const std::filesystem::path& path, const std::string& what) {
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::regular) return;
  const bool missing = type == std::filesystem::file_type::not_found;
  const std::string reason = missing ? "no such file" : error ? error.message() : "not a file";
  throw UserError(path.string() + ": " + reason + "; " + what + " is a TOML file");
}

/// Larger files are nothing that people wrote.
constexpr std::size_t kMostBytes = 16'000'000;

std::string text_of(const std::filesystem::path& path, const std::string& what) {
  check_is_file(path, what);
  std::string text = read_file(path, kMostBytes + 1);
  if (text.size() <= kMostBytes) return text;
  throw UserError(path.string() + ": has more than " + std::to_string(kMostBytes / 1'000'000) +
                  " MB; " + what + " is a TOML file");
}

}  // namespace

std::string too_deep_toml() {
  return "nests deeper than " + std::to_string(kDeepestToml) +
         " levels; keys of a scene have three";
}

toml::table parse_toml_file(const std::filesystem::path& path, const std::string& what) {
  const std::string text = text_of(path, what);
  if (const auto line = line_nested_too_deep(text)) {
    throw UserError(path.string() + ": line " + std::to_string(*line) + ": " + too_deep_toml());
  }
  try {
    return toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    throw UserError(path.string() + ": line " + std::to_string(error.source().begin.line) + ": " +
                    std::string(error.description()));
  }
}

}  // namespace wobblebench::bench
