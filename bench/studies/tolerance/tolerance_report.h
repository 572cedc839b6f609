// What `run --tolerance` chose, what it promised and what was reached.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "bench/results/check.h"
#include "bench/studies/tolerance/tolerance_choice.h"

namespace wobblebench::bench {

/// A choice with the picture that was made by it.
struct ToleranceResult {
  ToleranceChoice choice;
  ToleranceOutcome outcome;
  double render_ms = 0;  ///< all passes of the picture
};

nlohmann::ordered_json tolerance_json(const ToleranceResult& result);

/// Two lines for a terminal.
std::string tolerance_lines(const ToleranceResult& result);

/// Whether the promise was made, and holds of this picture.
Check tolerance_check(const ToleranceResult& result);

}  // namespace wobblebench::bench
