// Rows of the independent tables of tests/yardstick.
#pragma once

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace wobblebench {

/// A row by the names of its columns.
class YardstickRow {
 public:
  std::string text(const std::string& column) const { return cells_.at(column); }
  double number(const std::string& column) const { return std::stod(cells_.at(column)); }

  std::map<std::string, std::string> cells_;
};

/// All rows of a table of one preset (empty: of all). Throws std::runtime_error if there are none.
inline std::vector<YardstickRow> yardstick(const std::string& name,
                                           const std::string& preset = "") {
  std::ifstream file(std::string(WOBBLEBENCH_YARDSTICK) + "/" + name + ".csv");
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::vector<std::string> columns;
  std::vector<YardstickRow> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    const auto cells = split(line);
    if (columns.empty()) {
      columns = cells;
      continue;
    }
    YardstickRow row;
    for (std::size_t i = 0; i < columns.size(); ++i) row.cells_[columns[i]] = cells.at(i);
    if (preset.empty() || row.text("preset") == preset) rows.push_back(row);
  }
  if (rows.empty()) throw std::runtime_error("no rows of " + name + " " + preset);
  return rows;
}

}  // namespace wobblebench
