#include "bench/output/document/table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/number_text.h"
#include "base/text.h"

namespace wobblebench::bench {

namespace {

constexpr int kFileDigits = 9;

const std::string& title_of(const Column& column) {
  return column.title.empty() ? column.key : column.title;
}

/// A cell's text must not end it, or its row.
std::string markdown_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c == '\n' || c == '\r' ? ' ' : c;
  }
  return escaped;
}

std::string markdown_cell(const Cell& cell, const Column& column) {
  const std::string text = markdown_text(cell.shown(column));
  return cell.is_code() && !text.empty() ? "`" + text + "`" : text;
}

/// Whether any cell of the column satisfies this.
template <class Predicate>
bool any_cell(const Table& table, std::size_t column, const Predicate& predicate) {
  return std::any_of(table.rows.begin(), table.rows.end(), [&](const std::vector<Cell>& row) {
    return predicate(row[column]);
  });
}

std::string csv_number(double value) {
  return std::isfinite(value) ? significant(value, kFileDigits) : "";
}

/// Without an exponent up to a million.
std::string significant_text(double value, int digits) {
  constexpr double kMost = 1e6;
  const double size = std::abs(value);
  const bool is_whole = size >= std::pow(10.0, digits) - 0.5 && size < kMost;
  return is_whole ? fixed(value, 0) : significant(value, digits);
}

std::string csv_cell(const Cell& cell) {
  if (!cell.is_number()) return csv_field(cell.text());
  return cell.is_whole() ? fixed(cell.number(), 0) : csv_number(cell.number());
}

/// "-0.00" as "0.00".
std::string without_sign_of_zero(std::string text) {
  if (text.find_first_not_of("-0.") == std::string::npos) std::erase(text, '-');
  return text;
}

nlohmann::ordered_json json_of(const Cell& cell) {
  if (cell.is_truth()) return cell.text() == "yes";

  if (!cell.text().empty()) return cell.text();
  if (!cell.is_number()) return nullptr;
  if (cell.is_whole()) return static_cast<std::int64_t>(cell.number());
  if (!cell.has_range()) return cell.number();
  return {{"value", cell.number()}, {"low", cell.low()}, {"high", cell.high()}};
}

}  // namespace

Cell Cell::interval(double middle, double half) {
  Cell cell = spread(middle, middle - half, middle + half);
  cell.is_interval_ = true;
  return cell;
}

Cell Cell::spread(double middle, double low, double high) {
  Cell cell(middle);
  cell.low_ = low;
  cell.high_ = high;
  return cell;
}

Cell Cell::code(std::string text) {
  Cell cell(std::move(text));
  cell.code_ = true;
  return cell;
}

Cell& Cell::bracket(bool on) {
  bracketed_ = on;
  return *this;
}

bool Cell::is_number() const {
  return std::isfinite(number_);
}

bool Cell::has_range() const {
  return is_number() && std::isfinite(low_) && std::isfinite(high_);
}

std::string Cell::shown(const Column& column) const {
  if (!is_number()) return text_;
  const auto text = [&](double value) {
    if (column.significant) return significant_text(value, column.digits);
    return without_sign_of_zero(fixed(value, whole_ ? 0 : column.digits));
  };
  std::string shown = text(number_);
  if (has_range()) {
    shown += is_interval_ ? std::string(" ± ") + text(high_ - number_)
                          : std::string(" (") + text(low_) + " to " + text(high_) + ")";
  }
  return bracketed_ ? "(" + shown + ")" : shown;
}

void Table::add(std::vector<Cell> row, std::string id) {
  if (row.size() != columns.size()) {
    throw std::logic_error("table " + name + ": a row of " + std::to_string(row.size()) +
                           " cells, but " + std::to_string(columns.size()) + " columns");
  }
  if (!id.empty() || !ids.empty()) {
    ids.resize(rows.size());
    ids.push_back(std::move(id));
  }
  rows.push_back(std::move(row));
}

Column column_of(const Measure& measure) {
  const Unit& unit = unit_of(measure.key);
  return {measure.key, measure.title, unit.name, unit.digits};
}

std::vector<Column> columns_of(std::vector<Column> first, Chosen measures) {
  for (const Measure* measure : measures) first.push_back(column_of(*measure));
  return first;
}

std::vector<Cell> cells_of(std::vector<Cell> first, const Measurements& found, Chosen measures) {
  for (const Measure* measure : measures) {
    const MeasuredValue* const one = found.find(measure->key);
    const bool whole = one != nullptr && one->whole;
    first.push_back(whole ? Cell(std::llround(one->value)) : Cell(found.value(*measure)));
  }
  return first;
}

Table with_columns(const Table& table, const std::vector<std::string>& keys) {
  Table chosen{.name = table.name, .caption = table.caption, .columns = {}, .ids = table.ids};
  chosen.rows.resize(table.rows.size());
  for (const std::string& key : keys) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.columns[i].key != key) continue;
      chosen.columns.push_back(table.columns[i]);
      for (std::size_t r = 0; r < table.rows.size(); ++r) {
        chosen.rows[r].push_back(table.rows[r][i]);
      }
    }
  }
  return chosen;
}

std::string heading(const Column& column) {
  return column.unit.empty() ? title_of(column) : title_of(column) + ", " + column.unit;
}

bool is_numeric(const Table& table, std::size_t column) {
  const auto is_text = [](const Cell& cell) { return !cell.text().empty(); };
  const auto is_number = [](const Cell& cell) { return cell.is_number(); };
  return any_cell(table, column, is_number) || !any_cell(table, column, is_text);
}

std::string markdown(const Table& table) {
  std::string names = "|", rule = "|", text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    names.append(" ").append(markdown_text(heading(table.columns[i]))).append(" |");
    rule += is_numeric(table, i) ? " ---: |" : " --- |";
  }
  if (!table.caption.empty()) text = table.caption + "\n\n";
  text += names + "\n" + rule + "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (std::size_t i = 0; i < row.size(); ++i) {
      text.append(" ").append(markdown_cell(row[i], table.columns[i])).append(" |");
    }
    text += "\n";
  }
  return text;
}

std::string csv(const Table& table) {
  std::vector<bool> ranged(table.columns.size());
  std::string text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    ranged[i] = any_cell(table, i, [](const Cell& cell) { return cell.has_range(); });
    const std::string key = csv_field(table.columns[i].key);
    text += (i > 0 ? "," : "") + key;
    if (ranged[i]) text += "," + key + "_low," + key + "_high";
  }
  text += "\n";
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const Cell& cell = row[i];
      if (i > 0) text += ",";
      text += csv_cell(cell);
      if (!ranged[i]) continue;
      text.append(",").append(csv_number(cell.low())).append(",").append(csv_number(cell.high()));
    }
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json to_json(const Table& table) {
  auto rows = nlohmann::ordered_json::array();
  for (const auto& row : table.rows) {
    auto object = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < row.size(); ++i) object[table.columns[i].key] = json_of(row[i]);
    rows.push_back(std::move(object));
  }
  return rows;
}

}  // namespace wobblebench::bench
