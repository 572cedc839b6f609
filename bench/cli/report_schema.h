// A JSON Schema (draft 2020-12) of report.json, from the figures' declarations.
#pragma once

#include <string>
#include <vector>

namespace wobblebench::bench {

/// `commands`: the names that a report may have.
std::string report_schema(const std::vector<std::string>& commands);

}  // namespace wobblebench::bench
