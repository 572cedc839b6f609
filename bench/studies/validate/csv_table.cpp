#include "bench/studies/validate/csv_table.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>

namespace wobblebench::bench {

namespace {

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

}  // namespace

CsvTable::CsvTable(std::string_view text) {
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.empty() || line.front() == '#') continue;
    auto fields = fields_of(line);
    if (columns_.empty()) {
      columns_ = std::move(fields);
    } else if (fields.size() == columns_.size()) {
      rows_.push_back(std::move(fields));
    } else {
      throw std::invalid_argument("line " + std::to_string(number) + ": " +
                                  std::to_string(fields.size()) + " fields where the heading has " +
                                  std::to_string(columns_.size()));
    }
  }
  if (columns_.empty()) throw std::invalid_argument("a table without a heading");
}

const std::string& CsvTable::text(std::size_t row, std::string_view column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) {
    throw std::invalid_argument("no column " + std::string(column));
  }
  return rows_.at(row)[static_cast<std::size_t>(found - columns_.begin())];
}

double CsvTable::number(std::size_t row, std::string_view column) const {
  const std::string& field = text(row, column);
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size()) {
    throw std::invalid_argument(std::string(column) + " = " + field + ": not a number");
  }
  return value;
}

}  // namespace wobblebench::bench
