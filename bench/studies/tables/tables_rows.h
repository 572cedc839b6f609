// Every measured row of the tables as one table: tables.csv, of which the document shows parts.
#pragma once

#include <string>
#include <vector>

#include "bench/output/document/table.h"
#include "bench/studies/tables/measure.h"

namespace wobblebench::bench {

/// One row for each row of a table, then those of table "arrival". Sides are those that were run.
Table all_rows(const TableResults& results, const TableRun& run);

/// Rows of the table with this id, and the columns with these keys.
Table part_of(const Table& rows, const std::string& id, const std::vector<std::string>& keys);

}  // namespace wobblebench::bench
