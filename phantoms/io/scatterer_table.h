// What a list of point scatterers says, whatever the file's format: columns with their units and
// ranges, and what its rows make (docs/decisions/0025-point-scatterers.md).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "phantoms/point_scatterers.h"

namespace wobblebench::phantoms {

struct ScattererColumn {
  enum Quantity { x, y, z, amplitude, id, time };
  std::string_view name;
  Quantity quantity;
  double unit;       ///< of the file's values in SI
  double low, high;  ///< allowed, in the file's unit
};

/// All that a list may have.
std::span<const ScattererColumn> scatterer_columns();

/// More rows than this are refused: they take 40 MB.
inline constexpr std::size_t kMostScattererRows = 1'000'000;

/// Collects rows. Functions throw std::invalid_argument with one line.
class ScattererTable {
 public:
  /// `row_word`: what a row is called, such as "line". `gain`: factor on each amplitude.
  ScattererTable(std::string row_word, double gain) : row_word_(std::move(row_word)), gain_(gain) {}

  /// In the order of the values of rows. Refuses unknown, missing and repeated columns, and one of
  /// `id` and `time_s` without the other.
  void set_columns(const std::vector<std::string>& names);
  std::size_t columns() const { return columns_.size(); }
  /// One value a column, in the file's units. `number`: of the row in its file.
  void add_row(std::size_t number, std::span<const double> values);
  /// Refuses a list without rows, and a track with two rows of one time.
  [[nodiscard]] PointScatterers take() &&;

  /// Throws "ROW NUMBER, column NAME = VALUE: ALLOWED".
  [[noreturn]] void refuse(std::size_t number,
                           std::size_t column,
                           const std::string& value,
                           const std::string& allowed) const;

 private:
  struct Row {
    std::size_t number;
    double id;
    ScattererKey key;
  };

  double checked(std::size_t number, std::size_t column, double value) const;
  bool has(ScattererColumn::Quantity quantity) const;
  void add_track(std::span<const Row> rows, PointScatterers& points) const;

  std::string row_word_;
  double gain_;
  std::vector<const ScattererColumn*> columns_;
  std::vector<Row> rows_;
};

}  // namespace wobblebench::phantoms
