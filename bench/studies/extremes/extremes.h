// Runs cases at the ends of what is allowed, and reports for each whether the required outcome
// occurred.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/cache/phantom_cache.h"
#include "bench/studies/extremes/extreme_cases.h"
#include "bench/studies/extremes/pass_errors.h"
#include "render/gl/context.h"
#include "render/presets.h"

namespace wobblebench::bench {

struct ExtremeOutcome {
  ExtremeCase of;
  std::string preset;
  bool rendered = false;
  std::string refusal;                       ///< its line; empty: rendered
  bool finite = false;                       ///< every number of every picture
  std::vector<PassError> errors;             ///< empty: not compared
  std::optional<long> changed_out_of_reach;  ///< pixels; of a single changed sample
  std::vector<std::string> failures;

  bool passed() const { return failures.empty(); }
};

/// Never throws for what a case does: an exception that is no refusal is a failure.
ExtremeOutcome run_extreme_case(const ExtremeCase& of,
                                render::RenderPreset preset,
                                render::GlContext& context,
                                PhantomCache& cache);

/// Whether every number is finite, where z may say that there is no surface, and every colour
/// within [0, 1].
bool is_finite(const PassPictures& pictures);

/// A number at the end of its range that no picture exercises: device time, sequence number, phase.
struct NumberOutcome {
  std::string name;
  double worst = 0;  ///< difference from the exact number
  double bound = 0;
  std::string unit;
  std::string how;  ///< what the exact number and the bound follow from
  bool passed() const { return worst <= bound; }
};

std::vector<NumberOutcome> run_number_cases();

}  // namespace wobblebench::bench
