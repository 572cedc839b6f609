// Comma-separated tables with a heading.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace wobblebench::bench {

/// Fields without quotes; lines that begin with # are comments.
class CsvTable {
 public:
  /// Throws std::invalid_argument, which names the line, if a line has not as many fields as the
  /// heading, or there is none.
  explicit CsvTable(std::string_view text);

  std::size_t rows() const { return rows_.size(); }
  /// Throws std::invalid_argument for a column that is not in the heading.
  const std::string& text(std::size_t row, std::string_view column) const;
  /// Throws std::invalid_argument also for a field that is not a number.
  double number(std::size_t row, std::string_view column) const;

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace wobblebench::bench
