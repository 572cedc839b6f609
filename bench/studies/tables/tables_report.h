// The measured tables as a document and as report.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/tables/compared_pictures.h"
#include "bench/studies/tables/measure.h"
#include "bench/studies/tables/volumes.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// Provenance: this machine, the context and the board that the volumes came from.
Provenance provenance_of(const render::GlContext& context, const TableVolumes& volumes);

/// A few sentences: how the run differs from the paper's, and what was measured.
std::string describe_run(const TableRun& run);

/// What people read, with tables.csv. `note`: a sentence about the volumes; may be empty.
Document tables_document(const TableResults& results,
                         const TableRun& run,
                         const std::string& note,
                         const Provenance& provenance);

/// This context's pictures against another's.
struct PicturesAgainst {
  std::string other;  ///< GL_RENDERER of the other context, and its commit
  std::vector<PictureAgreement> agreements;

  bool all_explained() const;
};

/// What people read of it.
void add_agreement(const PicturesAgainst& against, Document& document);

/// A panel for each table: time relative to the reference row, the paper's, plain and fast.
std::vector<Figure> tables_figures(const TableResults& results, const TableRun& run);

/// Adds run, reference, tables and stages to the head of report.json, and of the document the
/// tables of what arrives, of the floor, of fetches and of agreement.
void add_tables(nlohmann::ordered_json& report,
                const TableResults& results,
                const TableRun& run,
                const std::string& note,
                const Document& document);

}  // namespace wobblebench::bench
