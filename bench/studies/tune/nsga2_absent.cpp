// In place of nsga2.cpp where pagmo was missing.
#include <stdexcept>

#include "bench/studies/tune/nsga2.h"

namespace wobblebench::bench {

bool has_nsga2() {
  return false;
}

void breed_nsga2(const std::vector<SearchAxis>&,
                 const std::vector<SearchPoint>&,
                 std::uint64_t,
                 const SearchFunction&,
                 const std::function<bool()>&) {
  throw std::runtime_error("this program was built without pagmo");
}

}  // namespace wobblebench::bench
