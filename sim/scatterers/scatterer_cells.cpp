#include "sim/scatterers/scatterer_cells.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace wobblebench::sim {

namespace {

/// Hash cells along a parcel's side, of the densest octave and of each one before it: about half as
/// many cells in each. Measured: smaller parcels cost more to find.
constexpr int kDivisions[] = {6, 5, 4, 3, 2};
static_assert(kDivisions[0] * kDivisions[0] * kDivisions[0] <= kMostCells);
constexpr int kMostOctaves = static_cast<int>(std::size(kDivisions));

}  // namespace

std::uint32_t Octave::parcel_key(const glm::ivec3& parcel) const {
  const auto lane = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
  const std::uint64_t xy = mix(key ^ (lane(parcel.x) << 32 | lane(parcel.y)));
  return static_cast<std::uint32_t>(mix(xy + lane(parcel.z) * kGoldenGamma) >> 32);
}

ScattererCells::ScattererCells(double per_m3, double largest, std::uint64_t seed) {
  const int more = std::clamp(static_cast<int>(std::log2(largest)), 0, kMostOctaves);
  // From the largest cell's octave to the densest; the first is as dense as the second.
  std::vector<int> divisions;
  for (int i = 0; i <= more; ++i) {
    divisions.push_back(kDivisions[std::max(more - std::max(i, 1), 0)]);
  }
  double in_parcel = 0;
  for (int n : divisions) in_parcel += kScatterersInCell * std::pow(n, 3);
  parcel_m = std::cbrt(in_parcel / per_m3);
  for (std::size_t i = 0; i < divisions.size(); ++i) {
    octaves.push_back({kScatterersInCell * std::pow(divisions[i] / parcel_m, 3),
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
