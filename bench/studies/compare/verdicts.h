// Two sides' runs against the limits of their difference.
#pragma once

#include <string>
#include <vector>

#include "bench/evaluation/seed_statistics.h"
#include "bench/studies/compare/limits_file.h"
#include "bench/studies/compare/run_figures.h"

namespace wobblebench::bench {

/// The worst first.
enum class Outcome {
  broken,
  open,  ///< the interval has the limit in it: more seeds would tell
  kept,
  not_compared,  ///< see `why`
};
const char* to_string(Outcome outcome);

/// A limit on one scene.
struct Verdict {
  std::string scene;
  ChangeLimit limit;
  MeanInterval base, now;  ///< over the runs
  /// Paired by seed. Limits of Allowed::ratio: the geometric mean of new over base, less 1, with
  /// the interval of its logarithm; else new less base. One pair alone, and pairs that are all
  /// alike, have no half.
  MeanInterval change;
  Outcome outcome = Outcome::not_compared;
  std::string why = {};
};

/// A verdict for each scene and limit. The limit is broken where the whole 95 % interval of the
/// change lies beyond it, and kept where the whole interval lies within; a single pair is taken at
/// its value, or leaves a limit of time open. What is counted has no noise: one pair beyond a limit
/// breaks it. Times are not compared with those of a side that was
/// kept, nor work between renderers (GL_RENDERER) that round differently.
std::vector<Verdict> verdicts(const MeasuredSide& base,
                              const MeasuredSide& now,
                              const std::vector<ChangeLimit>& limits);

/// Whether only limits of times are broken, and at least one is: a second measurement may tell.
bool only_times_are_broken(const std::vector<Verdict>& all);

/// "+0.20 (+0.18 to +0.22)", of a limited ratio in per cent.
std::string change_text(const Verdict& verdict);
/// "face: p95_mm 1.90 to 2.10 mm: +0.20 (+0.18 to +0.22); worse by at most 0.1 mm".
std::string line_of(const Verdict& verdict);

}  // namespace wobblebench::bench
