// Tables of results: a study fills one in, and it is written as Markdown, CSV, JSON and HTML.
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/statistics.h"
#include "bench/results/measure.h"

namespace wobblebench::bench {

struct Column {
  std::string key;         ///< in CSV and JSON, with the unit: "rms_mm"
  std::string title = {};  ///< for people, without the unit: "RMS"; empty: the key
  std::string unit = {};   ///< "mm", "%"; empty: none
  int digits = 2;  ///< after the decimal point, for people; CSV and JSON have nine significant ones
  bool significant = false;  ///< `digits` counts significant digits: for values of many sizes
};

/// What stands in one place of a table: nothing, a text, or a number, which may have an interval or
/// the ends of a spread beside it. A number that is not finite is nothing.
class Cell {
 public:
  Cell() = default;
  // A row is a list of values: {"filter", 4.2, 12}.
  // NOLINTBEGIN(google-explicit-constructor)
  Cell(std::string text) : text_(std::move(text)) {}
  Cell(const char* text) : text_(text) {}
  Cell(double number) : number_(number) {}
  Cell(const Spread& of) : Cell(spread(of.median, of.min, of.max)) {}
  template <std::integral Truth>
  requires std::same_as<Truth, bool> Cell(Truth truth)
      : text_(truth ? "yes" : "no"), truth_(true) {}
  template <std::integral Integer>
  Cell(Integer number) : number_(static_cast<double>(number)), whole_(true) {}
  // NOLINTEND(google-explicit-constructor)

  /// "1.25 ± 0.10"; without the half where that is not finite.
  static Cell interval(double middle, double half);
  /// "1.25 (1.20 to 1.40)".
  static Cell spread(double middle, double low, double high);
  /// A name of the command line or of a file, set in type of one width.
  static Cell code(std::string text);

  /// In brackets, for people: the number is not told from 0.
  Cell& bracket(bool on = true);

  bool is_number() const;
  bool is_whole() const { return whole_; }
  bool is_code() const { return code_; }
  bool is_truth() const { return truth_; }
  bool has_range() const;
  const std::string& text() const { return text_; }
  double number() const { return number_; }
  double low() const { return low_; }
  double high() const { return high_; }

  /// For people; "" of nothing.
  std::string shown(const Column& column) const;

 private:
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::string text_;
  double number_ = kNone;
  double low_ = kNone;
  double high_ = kNone;
  bool is_interval_ = false;  ///< else low and high are those of a spread
  bool whole_ = false;        ///< shown without digits after the point
  bool code_ = false;
  bool truth_ = false;  ///< "yes" or "no"
  bool bracketed_ = false;
};

/// Rows of cells below columns.
///
/// @code
/// Table table{.name = "passes", .columns = {{"pass"}, {"median_ms", "time", "ms", 1}}};
/// table.add({"filter", Cell::spread(4.2, 4.0, 5.1)});
/// out.write_text("passes.csv", csv(table));
/// @endcode
struct Table {
  std::string name;          ///< short, of [a-z0-9_]: unique in a document
  std::string caption = {};  ///< one sentence or title above it; empty: none
  std::vector<Column> columns = {};
  std::vector<std::vector<Cell>> rows = {};
  /// What each row is about, as points of charts name it (Series::ids); empty, or one a row.
  std::vector<std::string> ids = {};

  /// Throws std::logic_error where the number of cells is not that of the columns.
  void add(std::vector<Cell> row, std::string id = "");
};

/// A column, and what stands in it: a member of the rows' type, or a function of a row.
template <class Row>
struct Field {
  Column column;
  std::function<Cell(const Row&)> cell;

  template <class Value>
  Field(Column of, Value value)
      : column(std::move(of)),
        cell([value](const Row& row) -> Cell { return std::invoke(value, row); }) {}
};

/// A row for each of `rows`.
///
/// @code
/// struct Pass { std::string name; double ms; };
/// const std::vector<Pass> passes = {{"filter", 4.2}};
/// const bench::Table table = bench::table_of<Pass>(
///     {.name = "passes"}, passes, {{{"pass"}, &Pass::name}, {{"ms", "time", "ms", 1},
///     &Pass::ms}});
/// @endcode
template <class Row, class Rows>
Table table_of(Table head, const Rows& rows, const std::vector<Field<Row>>& fields) {
  for (const Field<Row>& field : fields) head.columns.push_back(field.column);
  for (const Row& row : rows) {
    std::vector<Cell> cells;
    for (const Field<Row>& field : fields) cells.push_back(field.cell(row));
    head.add(std::move(cells));
  }
  return head;
}

Column column_of(const Measure& measure);
/// Columns of figures, behind others.
std::vector<Column> columns_of(std::vector<Column> first, Chosen measures);
/// A row of them, behind other cells.
std::vector<Cell> cells_of(std::vector<Cell> first, const Measurements& found, Chosen measures);

/// The same rows with the columns of these keys, in this order; keys that are not there are left
/// out.
Table with_columns(const Table& table, const std::vector<std::string>& keys);

/// Title with its unit: "RMS, mm".
std::string heading(const Column& column);

/// Whether the column's values stand to the right: it has numbers, or nothing at all.
bool is_numeric(const Table& table, std::size_t column);

std::string markdown(const Table& table);
/// A header of keys; a column in which any cell has a range is followed by KEY_low and KEY_high.
/// RFC 4180, lines end with "\n".
std::string csv(const Table& table);
/// A list of objects by keys. A number with a range is {"value", "low", "high"}; nothing is null.
nlohmann::ordered_json to_json(const Table& table);

}  // namespace wobblebench::bench
