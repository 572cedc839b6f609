// The error for bad input of the user: a message on one line, exit code 2.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/text.h"

namespace wobblebench {

/// `text` without its middle if it is long: what begins with a file and a key and ends with what is
/// allowed may have a value of megabytes between them.
inline std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 2000, kHead = 600, kTail = 1000;
  if (text.size() <= kMost) return text;
  std::size_t head = kHead, tail = text.size() - kTail;
  const auto is_within = [&](std::size_t i) {  // a character of several bytes
    return (static_cast<unsigned char>(text[i]) & 0xc0) == 0x80;
  };
  while (head > kHead - 3 && is_within(head)) --head;
  while (tail < text.size() - kTail + 3 && is_within(tail)) ++tail;
  return text.substr(0, head) + " … (" + std::to_string(tail - head) + " bytes) … " +
         text.substr(tail);
}

/// `text` shortened, with control characters, and bytes that are no UTF-8, as escapes: a value from
/// a file or a shell cannot break a message into lines.
inline std::string one_line(const std::string& whole) {
  const std::string text = shortened(whole);
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
