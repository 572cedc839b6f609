#include "base/number_text.h"

#include <charconv>
#include <system_error>

namespace wobblebench {

namespace {

std::string to_text(double value, std::chars_format format, int digits) {
  std::string text(32, '\0');
  for (;;) {
    char* const begin = text.data();
    const auto [end, error] = std::to_chars(begin, begin + text.size(), value, format, digits);
    if (error == std::errc()) {
      text.resize(static_cast<std::size_t>(end - begin));
      return text;
    }
    text.resize(2 * text.size());
  }
}

}  // namespace

std::string fixed(double value, int digits) {
  return to_text(value, std::chars_format::fixed, digits);
}

std::string significant(double value, int digits) {
  return to_text(value, std::chars_format::general, digits);
}

}  // namespace wobblebench
