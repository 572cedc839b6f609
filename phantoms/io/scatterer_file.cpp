#include "phantoms/io/scatterer_file.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "phantoms/io/import_process.h"
#include "phantoms/io/mesh_file.h"
#include "phantoms/io/message.h"
#include "phantoms/io/scatterer_csv.h"
#include "phantoms/io/scatterer_table.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

namespace fs = std::filesystem;

/// Larger than any list of kMostScattererRows.
constexpr std::uintmax_t kMostBytes = 500'000'000;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) throw std::invalid_argument("cannot be read");
  return std::move(text).str();
}

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
  if (bytes > kMostBytes) throw std::invalid_argument("has more than 500 MB");
}

PointScatterers read_list(const fs::path& path, double gain) {
  const std::string extension = lower_case_extension(path);
  const bool hdf5 = extension == ".h5" || extension == ".hdf5";
  if (!hdf5 && extension != ".csv") throw std::invalid_argument("must be a .csv or an .h5");
  check_is_list(path);
  if (!hdf5) return scatterers_from_csv(text_of(path), gain);
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

}  // namespace wobblebench::phantoms
