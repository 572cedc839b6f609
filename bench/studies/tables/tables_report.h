// The measured tables as tables.md, tables.csv and report.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/provenance.h"
#include "bench/studies/tables/measure.h"
#include "bench/studies/tables/volumes.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// Provenance: this machine, the context and the board that the volumes came from.
Provenance provenance_of(const render::GlContext& context, const TableVolumes& volumes);

/// A few sentences: how the run differs from the paper's, and what was measured.
std::string describe_run(const TableRun& run);

/// tables.md. `note`: a sentence about the volumes; may be empty.
std::string to_markdown(const TableResults& results,
                        const TableRun& run,
                        const std::string& note,
                        const Provenance& provenance);

/// tables.csv: one line a row of a table, then the lines of table "arrival".
std::string to_csv(const TableResults& results, const TableRun& run);

/// Adds run, reference, tables and arrival to the head of report.json.
void add_tables(nlohmann::ordered_json& report,
                const TableResults& results,
                const TableRun& run,
                const std::string& note);

}  // namespace wobblebench::bench
