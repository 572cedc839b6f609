// The one error of the command line for what a user gave it: a message on one line, exit code 2.
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>

#include "base/text.h"

namespace wobblebench::bench {

/// `text` with control characters, and bytes that are no UTF-8, written as escapes, so that a value
/// out of a file or a shell cannot break a message into lines.
inline std::string one_line(const std::string& text) {
  const bool utf8 = is_utf8(text);
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n') {
      line += "\\n";
    } else if (is_control(c) || (byte >= 0x80 && !utf8)) {
      char escaped[5];
      std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<unsigned>(byte));
      line += escaped;
    } else {
      line += c;
    }
  }
  return line;
}

/// what() names file (or option), key, value and what is allowed, on one line.
class UserError : public std::runtime_error {
 public:
  explicit UserError(const std::string& message) : std::runtime_error(one_line(message)) {}
};

}  // namespace wobblebench::bench
