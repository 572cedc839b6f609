// What `compare` says: verdicts, figures, pictures.
#pragma once

#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/output/junit.h"
#include "bench/studies/compare/verdicts.h"

namespace wobblebench::bench {

struct ComparisonResult {
  MeasuredSide base, now;
  std::vector<ChangeLimit> limits;
  std::vector<Verdict> verdicts;
  bool measured_twice = false;  ///< because a limit of time was broken
  /// Scenes whose pictures are staged, as base_SCENE_surface.png, new_SCENE_error.png and alike.
  std::vector<std::string> with_surface, with_error;
};

/// One line: how many limits are broken, open, kept and not compared.
std::string verdict_line(const ComparisonResult& result);
/// Lines of what is broken, then of what is open.
std::string verdict_lines(const ComparisonResult& result);

std::vector<Check> test_cases(const ComparisonResult& result);
Document compare_document(const ComparisonResult& result);

}  // namespace wobblebench::bench
