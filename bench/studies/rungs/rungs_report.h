// Speed against accuracy of the simulator's rungs, as a document and as report.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/rungs/rung_comparison.h"

namespace wobblebench::bench {

/// File of frames_picture().
inline constexpr const char* kFramesFile = "rungs_frames.png";

/// The middle frame of the phantom on each rung.
Image<glm::vec3> frames_picture(const RungsResults& results);

/// Each rung's time against its error against the rung above.
Figure rungs_figure(const RungsResults& results);
Figure growth_figure(const RungsResults& results);
Figure tissue_figure(const RungsResults& results);

Document rungs_document(const RungsResults& results, const Provenance& provenance);

/// "rungs" of report.json: those of which none is both faster and nearer to the truth ("front"),
/// and the document's tables.
nlohmann::ordered_json rungs_json(const RungsResults& results, const Document& document);

}  // namespace wobblebench::bench
