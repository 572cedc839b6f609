// report.html of a command.
#pragma once

#include <string>

#include "bench/output/page/page.h"

namespace wobblebench::bench {

/// The document, with what the command warned of before it and, behind it, how it was made: command
/// line, provenance, times of the steps, and the scene with every option. `report`: the text of
/// report.json.
std::string report_page(Document document,
                        const std::string& report,
                        const std::string& command_line,
                        const ReadPicture& read_picture);

}  // namespace wobblebench::bench
