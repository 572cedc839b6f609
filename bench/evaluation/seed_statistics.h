// Means over seeds, with what is known of them.
#pragma once

#include <cstdint>
#include <vector>

namespace wobblebench::bench {

/// first, first + 1, …
std::vector<std::uint64_t> seeds_from(std::uint64_t first, int count);

/// A mean and its 95 % interval, mean - half to mean + half: Student's t for independent, about
/// normal values.
struct MeanInterval {
  double mean = 0;  ///< NaN where there are no values
  double half = 0;  ///< NaN where there are fewer than two
  int n = 0;

  /// The interval does not contain 0. False where there is none.
  bool differs_from_zero() const { return mean - half > 0 || mean + half < 0; }
};

/// Values that are not finite are left out.
MeanInterval mean_interval(const std::vector<double>& values);

/// What a further value, of another seed, stays below with a probability of 95 %: mean + t s sqrt(1
/// + 1/n). Infinite where fewer than two values are known.
double upper_of_next(const MeanInterval& known);

/// Mean of values[i] - references[i], both of the same seed: what the seed does to both cancels.
/// Throws std::invalid_argument for lists of different lengths.
MeanInterval paired_difference(const std::vector<double>& values,
                               const std::vector<double>& references);

}  // namespace wobblebench::bench
