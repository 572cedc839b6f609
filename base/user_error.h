// The error for bad input of the user: a message on one line, exit code 2.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "base/text.h"

namespace wobblebench {

/// `text` with control characters, and bytes that are no UTF-8, as escapes: a value from a file or
/// a shell cannot break a message into lines.
inline std::string one_line(const std::string& text) {
  const bool utf8 = is_utf8(text);
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n') {
      line += "\\n";
    } else if (is_control(c) || (byte >= 0x80 && !utf8)) {
      constexpr std::string_view kDigits = "0123456789abcdef";
      line += {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
    } else {
      line += c;
    }
  }
  return line;
}

/// what() names file or option, key, value and what is allowed.
class UserError : public std::runtime_error {
 public:
  explicit UserError(const std::string& message) : std::runtime_error(one_line(message)) {}
};

}  // namespace wobblebench
