#include "phantoms/io/scatterer_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "base/file.h"
#include "base/number_text.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"
#include "phantoms/io/triangle_mesh.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

// A column that a list of any format may have, with its unit and range.
struct Column {
  enum Quantity { x, y, z, amplitude, id, time };
  std::string_view name;
  Quantity quantity;
  double unit;       ///< unit of the file's values, in SI
  double low, high;  ///< allowed, in the file's unit
};

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

bool is_column(std::string_view name) {
  return std::ranges::find(kColumns, name, &Column::name) != kColumns.end();
}

const Column& column_of(const std::string& name) {
  const auto found = std::ranges::find(kColumns, name, &Column::name);
  if (found != kColumns.end()) return *found;
  throw std::invalid_argument("column \"" + name +
                              "\": must be one of x_mm, y_mm, z_mm (or x_m, y_m, z_m), amplitude, "
                              "id, time_s");
}

/// Collects the rows of a list of any format. Functions throw std::invalid_argument with one line.
class ScattererTable {
 public:
  /// `row_word`: what a row is called, such as "line". `gain`: factor on each amplitude.
  ScattererTable(std::string row_word, double gain) : row_word_(std::move(row_word)), gain_(gain) {}

  /// `names`: in the order of the values of rows. Refuses unknown, missing and repeated columns,
  /// and one of `id` and `time_s` without the other.
  void set_columns(const std::vector<std::string>& names);
  std::size_t columns() const { return columns_.size(); }
  /// One value a column, in the file's units. `number`: number of the row in its file.
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
  bool has(Column::Quantity quantity) const;
  void add_track(std::span<const Row> rows, PointScatterers& points) const;

  std::string row_word_;
  double gain_;
  std::vector<const Column*> columns_;
  std::vector<Row> rows_;
};

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

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// Takes what stands before the next `separator`, or all that is left, from `text`.
std::string_view take_until(char separator, std::string_view& text) {
  const auto at = text.find(separator);
  const std::string_view taken = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + 1);
  return taken;
}

/// Values between commas, without the quotes that some programs put about them.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (bool last = false; !last;) {
    last = line.find(',') == std::string_view::npos;
    std::string_view field = trimmed(take_until(',', line));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
      field = trimmed(field.substr(1, field.size() - 2));
    }
    fields.push_back(field);
  }
  return fields;
}

/// Any number that a double holds, infinities and NaN too.
std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

class CsvReader {
 public:
  explicit CsvReader(double gain) : table_("line", gain) {}

  void read_line(std::size_t number, std::string_view line) {
    line = trimmed(line);
    if (table_.columns() == 0 && line.starts_with('#')) note_header(number, line.substr(1));
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) return;
    const auto fields = fields_of(line);
    if (table_.columns() > 0) return read_row(number, fields);
    if (!number_in(fields[0])) return read_header(number, fields);
    if (noted_.empty()) {
      throw std::invalid_argument("line " + std::to_string(number) +
                                  ": must be preceded by a header line of column names, such as "
                                  "x_mm,y_mm,z_mm,amplitude");
    }
    read_header(noted_line_, noted_);
    read_row(number, fields);
  }
  PointScatterers take() && {
    if (table_.columns() == 0) throw std::invalid_argument("has no header line of column names");
    return std::move(table_).take();
  }

 private:
  /// numpy.savetxt() writes its header as a comment: the last one of column names alone is the
  /// header if numbers follow it.
  void note_header(std::size_t number, std::string_view comment) {
    const auto fields = fields_of(comment);
    if (fields.size() < 2 || !std::ranges::all_of(fields, is_column)) return;
    noted_ = fields;
    noted_line_ = number;
  }

  void read_header(std::size_t number, const std::vector<std::string_view>& fields) {
    try {
      table_.set_columns({fields.begin(), fields.end()});
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("line " + std::to_string(number) +
                                  ", the header: " + error.what());
    }
  }

  void read_row(std::size_t number, const std::vector<std::string_view>& fields) {
    if (fields.size() != table_.columns()) {
      throw std::invalid_argument("line " + std::to_string(number) + ": has " +
                                  std::to_string(fields.size()) + " values; must have " +
                                  std::to_string(table_.columns()) +
                                  ", one a column, separated by commas");
    }
    values_.clear();
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const auto value = number_in(fields[i]);
      if (!value) table_.refuse(number, i, std::string(fields[i]), "must be a number");
      values_.push_back(*value);
    }
    table_.add_row(number, values_);
  }

  ScattererTable table_;
  std::vector<std::string_view> noted_;  ///< column names in a comment, and their line
  std::size_t noted_line_ = 0;
  std::vector<double> values_;
};

/// Appends the shortest text that reads back as the same number.
void append(double value, std::string& text) {
  std::array<char, 32> digits{};
  text.append(digits.data(),
              std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

namespace fs = std::filesystem;

/// Larger than any list of kMostScattererRows.
constexpr std::uintmax_t kMostFileBytes = 500'000'000;

void check_is_list(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    const bool missing = !error || error == std::errc::no_such_file_or_directory;
    throw std::invalid_argument(fs::exists(path, error) ? "is not a file"
                                : missing               ? "no such file"
                                                        : error.message());
  }
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (bytes == 0) throw std::invalid_argument("is empty");
  if (bytes > kMostFileBytes) throw std::invalid_argument("has more than 500 MB");
}

// The list of a message of wobblebench-import, of which nothing is trusted.
PointScatterers scatterers_from_message(std::string_view message, double gain) {
  MessageReader in(message);
  std::vector<std::string> names;
  std::vector<std::string_view> columns;
  while (!in.at_end()) {
    names.push_back(in.text());
    columns.push_back(in.list<double>());
    if (columns.back().size() == columns.front().size()) continue;
    throw std::invalid_argument(names.back() + " has another number of values than " +
                                names.front());
  }
  ScattererTable table("row", gain);
  table.set_columns(names);
  std::vector<double> values(columns.size());
  const std::size_t rows = columns.front().size() / sizeof(double);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      std::memcpy(&values[i], columns[i].data() + row * sizeof(double), sizeof(double));
    }
    table.add_row(row + 1, values);
  }
  return std::move(table).take();
}

PointScatterers read_list(const fs::path& path, double gain) {
  const std::string extension = lower_case_extension(path);
  const bool hdf5 = extension == ".h5" || extension == ".hdf5";
  if (!hdf5 && extension != ".csv") throw std::invalid_argument("must be a .csv or an .h5");
  check_is_list(path);
  if (!hdf5) return scatterers_from_csv(read_file(path), gain);
  return scatterers_from_message(ImportedBytes(ImportFormat::hdf5, path).message(), gain);
}

}  // namespace

PointScatterers read_scatterers(const PhantomOptions& options) {
  if (options.scatterers.empty()) return {};
  try {
    return read_list(options.scatterers, std::pow(10.0, options.scatterers_gain_db / 20));
  } catch (const std::invalid_argument& error) {
    throw refusal("scatterers", quoted(options.scatterers), error.what());
  }
}

PointScatterers scatterers_from_csv(std::string_view text, double gain) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  CsvReader reader(gain);
  for (std::size_t line = 1; !text.empty(); ++line) reader.read_line(line, take_until('\n', text));
  return std::move(reader).take();
}

std::string scatterers_to_csv(const PointScatterers& points) {
  const bool tracks = !points.all_fixed();
  std::string text = tracks ? "x_m,y_m,z_m,amplitude,id,time_s\n" : "x_m,y_m,z_m,amplitude\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const auto& [time_s, point] : points.track(i)) {
      for (int axis = 0; axis < 3; ++axis) {
        append(point.position_m[axis], text);
        text += ',';
      }
      append(point.amplitude, text);
      if (tracks) {
        text += ',';
        text += std::to_string(i);
        text += ',';
        append(time_s, text);
      }
      text += '\n';
    }
  }
  return text;
}

}  // namespace wobblebench::phantoms
