// Prints what the faces of many identities measure, as CSV, for script/population:
//   fetal_population FIRST LAST WEEKS
// A face that cannot be built leaves its measures empty.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "phantoms/fetal/fetal_child.h"
#include "phantoms/options.h"

namespace {

using wobblebench::phantoms::PhantomMeasure;

std::vector<PhantomMeasure> measured(std::uint64_t identity, double weeks) {
  wobblebench::phantoms::PhantomOptions options;
  options.gestational_age_weeks = weeks;
  options.identity = identity;
  try {
    return measures_of(make_child(options));
  } catch (const wobblebench::phantoms::InvalidPhantom&) {
    return {};
  }
}

std::string row(std::uint64_t identity, double weeks, std::size_t columns) {
  std::string text = std::to_string(identity) + "," + std::to_string(weeks);
  const auto measures = measured(identity, weeks);
  for (std::size_t i = 0; i < columns; ++i) {
    text += ',';
    if (!measures.empty()) text += std::to_string(measures[i].value);
  }
  return text;
}

int print(int first, int last, double weeks) {
  const auto mean = measured(0, weeks);
  std::string header = "identity,weeks";
  for (const PhantomMeasure& measure : mean) header += "," + measure.name;
  std::puts(header.c_str());
  std::vector<std::string> rows(static_cast<std::size_t>(last - first + 1));
  wobblebench::parallel_rows(static_cast<int>(rows.size()), [&](int i) {
    rows[static_cast<std::size_t>(i)] =
        row(static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(i), weeks, mean.size());
  });
  for (const std::string& each : rows) std::puts(each.c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("fetal_population FIRST LAST WEEKS\n", stderr);
    return 2;
  }
  try {
    return print(std::atoi(argv[1]), std::atoi(argv[2]), std::atof(argv[3]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fetal_population: %s\n", error.what());
    return 1;
  }
}
