#include "bench/scene/toml_depth.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace wobblebench::bench {

namespace {

/// Reads a text from its begin to its end, over strings and comments.
class TomlScan {
 public:
  explicit TomlScan(std::string_view text) : left_(text) {}

  std::optional<int> line_too_deep() {
    while (!left_.empty()) {
      step();
      if (brackets_ > kDeepestToml || dots_ >= kDeepestToml) return line_;
    }
    return std::nullopt;
  }

 private:
  void step() {
    switch (left_.front()) {
      case '"':
      case '\'':
        return skip_string();
      case '#':
        return skip(std::min(left_.find('\n'), left_.size()));
      case '.':
        ++dots_;
        break;
      case '[':
      case '{':
        ++brackets_;
        dots_ = 0;
        break;
      case ']':
      case '}':
        // A text that is not valid may close more than it opens.
        if (brackets_ > 0) --brackets_;
        dots_ = 0;
        break;
      case ',':
      case '=':
      case '\n':
        dots_ = 0;
        break;
      default:
        break;
    }
    skip(1);
  }

  /// A string ends at its quotes; one of a single line also where the line ends.
  void skip_string() {
    const char quote = left_.front();
    const std::string three(3, quote);
    const bool many_lines = left_.starts_with(three);
    skip(many_lines ? 3 : 1);
    while (!left_.empty()) {
      if (quote == '"' && left_.front() == '\\' && left_.size() > 1 && left_[1] != '\n') {
        skip(2);
      } else if (many_lines ? left_.starts_with(three) : left_.front() == quote) {
        skip(many_lines ? 3 : 1);
        // Up to two quotes may stand before the closing three.
        for (int i = 0; i < 2 && many_lines && left_.starts_with(quote); ++i) skip(1);
        return;
      } else if (!many_lines && left_.front() == '\n') {
        return;
      } else {
        skip(1);
      }
    }
  }

  void skip(std::size_t count) {
    for (const char c : left_.substr(0, count)) line_ += c == '\n';
    left_.remove_prefix(count);
  }

  std::string_view left_;
  int line_ = 1;
  int brackets_ = 0;
  int dots_ = 0;  ///< of the key or number that is being read
};

}  // namespace

std::optional<int> line_nested_too_deep(std::string_view toml) {
  return TomlScan(toml).line_too_deep();
}

}  // namespace wobblebench::bench
