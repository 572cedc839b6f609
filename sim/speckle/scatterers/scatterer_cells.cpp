#include "sim/speckle/scatterers/scatterer_cells.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/hash.h"

namespace wobblebench::sim {

namespace {

/// Hash cells along a block's side, for the densest octave and each one before it, which has about
/// half as many cells. Smaller blocks took longer to search (measured).
constexpr int kDivisions[] = {6, 5, 4, 3, 2};
static_assert(kDivisions[0] * kDivisions[0] * kDivisions[0] <= kMaxCells);
constexpr int kMaxOctaves = static_cast<int>(std::size(kDivisions));

}  // namespace

std::uint32_t Octave::block_key(const glm::ivec3& block) const {
  const auto bits = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
  const std::uint64_t xy = mix64(key ^ (bits(block.x) << 32 | bits(block.y)));
  return static_cast<std::uint32_t>(mix64(xy + bits(block.z) * kGoldenGamma) >> 32);
}

ScattererCells::ScattererCells(double per_m3, double largest, std::uint64_t seed) {
  const int more = std::clamp(static_cast<int>(std::log2(largest)), 0, kMaxOctaves);
  // From the octave of the largest cells to the densest; the first is as dense as the second.
  std::vector<int> divisions;
  for (int i = 0; i <= more; ++i) {
    divisions.push_back(kDivisions[std::max(more - std::max(i, 1), 0)]);
  }
  double per_block = 0;
  for (int n : divisions) per_block += kScatterersInCell * std::pow(n, 3);
  block_m = std::cbrt(per_block / per_m3);
  for (std::size_t i = 0; i < divisions.size(); ++i) {
    octaves.push_back({kScatterersInCell * std::pow(divisions[i] / block_m, 3),
                       divisions[i],
                       random_key(seed, RandomStream::scatterers, i)});
  }
}

double ScattererCells::share(int octave, double per_m3) const {
  for (int i = 0; i < octave; ++i) per_m3 -= octaves[static_cast<std::size_t>(i)].per_m3;
  return std::clamp(per_m3 / octaves[static_cast<std::size_t>(octave)].per_m3, 0.0, 1.0);
}

double scatterer_power(double share, int scatterer) {
  return std::clamp(kScatterersInCell * share - scatterer, 0.0, 1.0);
}

}  // namespace wobblebench::sim
