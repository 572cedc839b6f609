// Which terms of the detection-error model help on scans that it was not fitted to.
#pragma once

#include <vector>

#include "bench/evaluation/error_model/detection_model.h"

namespace wobblebench::bench {

struct ChosenTerm {
  ErrorTerm term = kConstantTerm;
  double left = 1;  ///< mean share of the mean square that is left, with it and those before it
};

struct TermChoice {
  TakenTerms taken{};
  std::vector<ChosenTerm> order;  ///< as they were taken
  int folds = 0;
};

/// A term is taken only if it lessens what is left by this.
inline constexpr double kLeastGain = 0.01;

/// Forward selection by cross-validation: of the terms that are not taken, the one that leaves
/// least, until none gains kLeastGain. Each group of sets in `folds` is held out once, and the
/// share of its mean square that is left by a fit to all other rows counts alike, so that a surface
/// that is found well is as important as one that is not. Least squares, errors beyond twice the
/// scale of all (median absolute deviation) with less weight.
TermChoice choose_terms(const std::vector<ErrorRow>& rows,
                        const std::vector<std::vector<int>>& folds);

}  // namespace wobblebench::bench
