#include "phantoms/io/scatterer_csv.h"

#include <array>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <vector>

#include "phantoms/io/scatterer_table.h"

namespace wobblebench::phantoms {
namespace {

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

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (bool last = false; !last;) {
    last = line.find(',') == std::string_view::npos;
    fields.push_back(trimmed(take_until(',', line)));
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
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) return;
    const auto fields = fields_of(line);
    if (table_.columns() == 0) {
      read_header(number, fields);
    } else {
      read_row(number, fields);
    }
  }
  PointScatterers take() && {
    if (table_.columns() == 0) throw std::invalid_argument("has no header line of column names");
    return std::move(table_).take();
  }

 private:
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
                                  std::to_string(table_.columns()) + ", one a column");
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
  std::vector<double> values_;
};

/// Appends the shortest text that reads back as the same number.
void append(double value, std::string& text) {
  std::array<char, 32> digits{};
  text.append(digits.data(),
              std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

}  // namespace

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
