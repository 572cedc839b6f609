// NSGA-II: Deb et al., IEEE Trans. Evol. Comput. 6 (2002) 182, by pagmo, which a build may be
// without.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "bench/studies/tune/tune_search.h"

namespace wobblebench::bench {

/// Breeds one generation after the other from `population`, a multiple of four points, by the
/// values (goal, excess) that `function` gives, as long as `goes_on()`, asked before each
/// generation, says so. Throws std::runtime_error where has_nsga2() is false.
void breed_nsga2(const std::vector<SearchAxis>& axes,
                 const std::vector<SearchPoint>& population,
                 std::uint64_t seed,
                 const SearchFunction& function,
                 const std::function<bool()>& goes_on);

}  // namespace wobblebench::bench
