// Report and document of the command `modes`.
#pragma once

#include <string>
#include <vector>

#include "bench/output/report_parts.h"
#include "bench/scene/scene.h"
#include "bench/studies/modes/mode_agreement.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string modes_report(const std::vector<ModeAgreement>& rows,
                         const Scene& scene,
                         const Provenance& provenance);

/// Markdown: a row for each phantom and direction.
std::string modes_markdown(const std::vector<ModeAgreement>& rows,
                           const Scene& scene,
                           const Provenance& provenance);

}  // namespace wobblebench::bench
