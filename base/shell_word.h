// Words of a shell's command line.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace wobblebench {

/// A word that stands for this text in a shell's command line: quoted where it needs it.
inline std::string shell_word(std::string_view text) {
  const auto is_plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_-./=,:+@%").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return std::string(text);
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace wobblebench
