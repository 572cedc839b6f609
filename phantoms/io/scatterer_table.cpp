#include "phantoms/io/scatterer_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "base/number_text.h"

namespace wobblebench::phantoms {
namespace {

using Column = ScattererColumn;

constexpr double kMillimetres = 1000, kMetres = 1, kSeconds = 1e6, kWhole = 9007199254740992.0;
constexpr double kUnbounded = 1e300;

constexpr std::array<Column, 9> kColumns = {
    {{"x_mm", Column::x, 1e-3, -kMillimetres, kMillimetres},
     {"y_mm", Column::y, 1e-3, -kMillimetres, kMillimetres},
     {"z_mm", Column::z, 1e-3, -kMillimetres, kMillimetres},
     {"x_m", Column::x, 1, -kMetres, kMetres},
     {"y_m", Column::y, 1, -kMetres, kMetres},
     {"z_m", Column::z, 1, -kMetres, kMetres},
     {"amplitude", Column::amplitude, 1, -kUnbounded, kUnbounded},
     {"id", Column::id, 1, 0, kWhole},
     {"time_s", Column::time, 1, -kSeconds, kSeconds}}};

std::string text_of(double value) {
  return significant(value, 12);
}

const Column& column_of(const std::string& name) {
  const auto found = std::ranges::find(kColumns, name, &Column::name);
  if (found != kColumns.end()) return *found;
  throw std::invalid_argument("column \"" + name +
                              "\": must be one of x_mm, y_mm, z_mm (or x_m, y_m, z_m), amplitude, "
                              "id, time_s");
}

}  // namespace

std::span<const ScattererColumn> scatterer_columns() {
  return kColumns;
}

bool ScattererTable::has(Column::Quantity quantity) const {
  return std::ranges::any_of(columns_, [&](const Column* c) { return c->quantity == quantity; });
}

void ScattererTable::set_columns(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const Column& column = column_of(name);
    if (has(column.quantity))
      throw std::invalid_argument("column \"" + name + "\": is there twice");
    columns_.push_back(&column);
  }
  for (const auto quantity : {Column::x, Column::y, Column::z, Column::amplitude}) {
    if (has(quantity)) continue;
    const auto missing = std::ranges::find(kColumns, quantity, &Column::quantity);
    throw std::invalid_argument("has no column " + std::string(missing->name));
  }
  if (has(Column::id) == has(Column::time)) return;
  throw std::invalid_argument(has(Column::id)
                                  ? "column \"id\": makes tracks, and needs a column time_s"
                                  : "column \"time_s\": makes tracks, and needs a column id");
}

void ScattererTable::refuse(std::size_t number,
                            std::size_t column,
                            const std::string& value,
                            const std::string& allowed) const {
  throw std::invalid_argument(row_word_ + " " + std::to_string(number) + ", column " +
                              std::string(columns_[column]->name) + " = " + value + ": " + allowed);
}

double ScattererTable::checked(std::size_t number, std::size_t column, double value) const {
  const Column& of = *columns_[column];
  const auto refused = [&](const std::string& why) { refuse(number, column, text_of(value), why); };
  if (!std::isfinite(value)) refused("must be a finite number");
  if (of.quantity == Column::amplitude && !(std::abs(value * gain_) <= 1)) {
    refused("must be within -1 and 1, a perfect mirror's, after phantom.scatterers_gain_db = " +
            text_of(20 * std::log10(gain_)));
  }
  if (of.quantity == Column::id && value != std::floor(value)) refused("must be a whole number");
  if (value < of.low || value > of.high) {
    refused("must be within " + text_of(of.low) + " and " + text_of(of.high));
  }
  return of.unit * value;
}

void ScattererTable::add_row(std::size_t number, std::span<const double> values) {
  if (rows_.size() >= kMostScattererRows) {
    throw std::invalid_argument("has more than " + std::to_string(kMostScattererRows) + " rows");
  }
  std::array<double, 6> of{};  // by quantity
  for (std::size_t i = 0; i < values.size(); ++i) {
    of[columns_[i]->quantity] = checked(number, i, values[i]);
  }
  rows_.push_back(
      {number,
       of[Column::id],
       {of[Column::time],
        {{of[Column::x], of[Column::y], of[Column::z]}, gain_ * of[Column::amplitude]}}});
}

void ScattererTable::add_track(std::span<const Row> rows, PointScatterers& points) const {
  std::vector<ScattererKey> keys;
  for (const Row& row : rows) {
    if (!keys.empty() && row.key.time_s == keys.back().time_s) {
      const auto column = std::ranges::find(columns_, Column::time, &Column::quantity);
      refuse(row.number,
             static_cast<std::size_t>(column - columns_.begin()),
             text_of(row.key.time_s),
             "id " + text_of(row.id) + " has this time already on " + row_word_ + " " +
                 std::to_string((&row - 1)->number));
    }
    keys.push_back(row.key);
  }
  points.add_track(keys);
}

PointScatterers ScattererTable::take() && {
  if (rows_.empty()) throw std::invalid_argument("holds no scatterers");
  PointScatterers points;
  if (!has(Column::id)) {
    for (const Row& row : rows_) points.add(row.key.point);
    return points;
  }
  std::ranges::stable_sort(
      rows_, {}, [](const Row& row) { return std::tuple(row.id, row.key.time_s); });
  for (std::size_t from = 0, to = 0; from < rows_.size(); from = to) {
    while (to < rows_.size() && rows_[to].id == rows_[from].id) ++to;
    add_track(std::span(rows_).subspan(from, to - from), points);
  }
  return points;
}

}  // namespace wobblebench::phantoms
