// Bias and spread of the signed depth error as functions of what can be measured of a pixel.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "bench/evaluation/error_model/pixel_terms.h"

namespace wobblebench::bench {

/// Terms of the logarithm of the spread.
inline constexpr std::size_t kSpreadTerms = 4;
/// Of a pixel: 1; beam width x sin(incidence), mm, both directions; contrast; depth, cm.
std::array<double, kSpreadTerms> spread_terms(const PixelTerms& pixel);
const std::array<TermDescription, kSpreadTerms>& spread_term_descriptions();

struct FittedTerm {
  double value = 0;
  double low = 0;  ///< 95 % interval of the block bootstrap
  double high = 0;
  bool fitted = false;  ///< false: it does not vary in the data, and is held at 0
};

struct DetectionModel {
  std::array<FittedTerm, kErrorTerms> bias;     ///< coefficients of the terms, units as they say
  std::array<FittedTerm, kSpreadTerms> spread;  ///< of log(spread / 1 mm)
  int rows = 0;                                 ///< pixels that it was fitted to
  int blocks = 0;                               ///< of the bootstrap
  std::vector<std::pair<int, int>> correlated;  ///< terms of the bias with |correlation| > 0.95

  /// Mean signed error along the pixel's ray, found less true; exactly 0 without terms.
  double bias_m(const PixelTerms& pixel) const;
  /// Standard deviation about it.
  double spread_m(const PixelTerms& pixel) const;
};

/// A pixel with both surfaces. Those farther apart than kOtherSurface_m are not of one surface;
/// they are left out, and counted by who collects rows.
struct ErrorRow {
  PixelTerms pixel;
  float error_m = 0;       ///< found less true depth along the ray
  std::int64_t block = 0;  ///< rows of one block have correlated errors
  int set = 0;             ///< of scans of one phantom at one pose
};
/// Which terms of the bias a model has; the others are held at 0.
using TakenTerms = std::array<bool, kErrorTerms>;
inline constexpr double kOtherSurface_m = 10e-3;

/// Ceres. The bias with a Huber loss beyond twice the scale of what it leaves (median absolute
/// deviation; two rounds), all pixels alike: weighted by their spread, those that need no
/// correction would decide it. Then the spread of what is left. Intervals by bootstrap of blocks.
DetectionModel fit_detection_model(const std::vector<ErrorRow>& rows, const TakenTerms& taken);

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
