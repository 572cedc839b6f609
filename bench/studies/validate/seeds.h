// Seeds of a study.
#pragma once

#include <cstdint>
#include <vector>

namespace wobblebench::bench {

/// first, first + 1, …
inline std::vector<std::uint64_t> seeds_from(std::uint64_t first, int count) {
  std::vector<std::uint64_t> seeds;
  for (int i = 0; i < count; ++i) seeds.push_back(first + static_cast<std::uint64_t>(i));
  return seeds;
}

}  // namespace wobblebench::bench
