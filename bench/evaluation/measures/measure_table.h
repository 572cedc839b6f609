// The measures of a picture as a table: one row a region, one column a measure.
#pragma once

#include <string>
#include <vector>

#include "bench/evaluation/measures/picture_measures.h"

namespace wobblebench::bench {

/// Names of the columns, with their units: bias_mm, p95_mm, missed_percent …
const std::vector<std::string>& measure_names();

struct MeasureRow {
  std::string group;           ///< of RegionError; "picture": all of it
  std::string region;          ///< "all" for the whole picture
  std::vector<double> values;  ///< one for each name; NaN: not formed, or not for regions
};

/// The whole picture first, then its regions. Without a surface in view no percentage is formed.
std::vector<MeasureRow> measure_rows(const PictureMeasures& measures);

}  // namespace wobblebench::bench
