#include <cmath>
#include <sstream>

#include "base/number_text.h"
#include "bench/studies/accuracy/accuracy_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kDigits = 7;

std::string cell(double value) {
  return std::isfinite(value) ? significant(value, kDigits) : "";
}

}  // namespace

std::string accuracy_csv(const AccuracyResults& results) {
  std::ostringstream csv;
  csv << "scene,rung,setting,seed,group,region";
  for (const std::string& name : measure_names()) csv << "," << name;
  csv << ",render_ms\n";
  for (const AccuracyRow& row : results.rows) {
    csv << row.scene << "," << row.rung << "," << row.setting << "," << row.seed << ","
        << row.measures.group << "," << row.measures.region;
    for (const double value : row.measures.values) csv << "," << cell(value);
    csv << "," << cell(row.render_ms) << "\n";
  }
  return csv.str();
}

std::string accuracy_picture_file(const AccuracyPicture& picture) {
  return "accuracy_" + picture.scene + "_" + picture.rung + "_" + picture.setting + ".png";
}

}  // namespace wobblebench::bench
