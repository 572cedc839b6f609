// Charts of the errors of whole pictures, and what they share with the tables.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bench/output/document/chart.h"
#include "bench/output/document/table.h"
#include "bench/studies/accuracy/accuracy_study.h"

namespace wobblebench::bench {

/// The figures of whole pictures that tables show.
Chosen picture_columns();

/// Names a summary of a whole picture in charts and tables.
std::string id_of(const AccuracySummary& s);

/// Median, P95, missed and false of one rung each: settings along the axis and a series for each
/// scene, or the other way round where there is one setting alone.
std::vector<Figure> accuracy_figures(const AccuracyResults& results);

}  // namespace wobblebench::bench
