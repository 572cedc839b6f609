// A search over settings that are numbers or names, for the least of a noisy function that is
// expensive to evaluate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace wobblebench::bench {

struct SearchAxis {
  int levels = 0;  ///< 0: any number from 0 to 1
};
/// For each axis the number of its level, or the number from 0 to 1.
using SearchPoint = std::vector<double>;

struct SearchValue {
  double goal = 0;    ///< to be made small
  double excess = 0;  ///< by how much limits are exceeded; 0: they hold
};
using SearchFunction = std::function<SearchValue(const SearchPoint&)>;

/// nsga2: Deb et al., IEEE Trans. Evol. Comput. 6 (2002) 182, by pagmo, over (goal, excess).
/// random: uniform over all axes, what a search must beat.
enum class SearchMethod { nsga2, random };

/// Whether this build has pagmo, and with it nsga2.
bool has_nsga2();

struct SearchOptions {
  SearchMethod method = SearchMethod::nsga2;
  int evaluations = 200;  ///< at most; a point is evaluated once, and its value kept
  std::uint64_t seed = 1;
};

/// Number of points of a generation of nsga2, and so of the starts that are taken at most.
inline constexpr std::size_t kSearchPopulation = 24;

/// Calls `function` for the points that it tries, the starts first. The same calls each time for
/// the same values.
void search(const std::vector<SearchAxis>& axes,
            const std::vector<SearchPoint>& starts,
            const SearchOptions& options,
            const SearchFunction& function);

}  // namespace wobblebench::bench
