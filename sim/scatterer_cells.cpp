#include "sim/scatterer_cells.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

/// Smaller cells follow the beam's rim better, larger ones cost less each; measured. Sixteen are
/// looked at together (sim/scatterer_kernels.h).
constexpr double kScatterersPerCell = 11;
/// Hash cells along a parcel's side, of the densest octave. With five, those of the next two
/// octaves (four, three) hold about as many scatterers each.
constexpr int kDivisions = 5;
constexpr int kMostOctaves = 7;

double cell_side(double per_m3) {
  return std::cbrt(kScatterersPerCell / per_m3);
}

int divisions_for(double per_m3, double parcel_m) {
  return std::max(1, static_cast<int>(std::lround(parcel_m / cell_side(per_m3))));
}

}  // namespace

PoissonCount::PoissonCount(double mean) {
  double term = std::exp(-mean), below = term;
  int count = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const double middle = (static_cast<double>(i) + 0.5) / static_cast<double>(counts_.size());
    while (below < middle && count < 255) {
      term *= mean / ++count;
      below += term;
    }
    counts_[i] = static_cast<std::uint8_t>(count);
  }
}

Octave::Octave(double density_per_m3, double parcel_m, std::uint64_t seed, int number)
    : per_m3(density_per_m3),
      divisions(divisions_for(density_per_m3, parcel_m)),
      key(random_key(seed, RandomStream::scatterers, static_cast<std::uint64_t>(number))),
      count(density_per_m3 * std::pow(parcel_m / divisions, 3)) {}

std::uint32_t Octave::parcel_key(const glm::ivec3& parcel) const {
  const auto lane = [](int i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
  const std::uint64_t xy = mix(key ^ (lane(parcel.x) << 32 | lane(parcel.y)));
  return static_cast<std::uint32_t>(mix(xy + lane(parcel.z) * kGoldenGamma) >> 32);
}

ScattererCells::ScattererCells(double per_m3, double widest, std::uint64_t seed) {
  const int more = std::clamp(static_cast<int>(std::log2(widest)), 0, kMostOctaves);
  // The densest octave fits exactly.
  const double densest = more == 0 ? per_m3 : 0.5 * per_m3;
  parcel_m = kDivisions * cell_side(densest);
  for (int i = 0; i <= more; ++i) {
    octaves.emplace_back(std::ldexp(per_m3, i == 0 ? -more : i - more - 1), parcel_m, seed, i);
  }
}

double octave_power(int octave, int octaves, double width) {
  if (octave == 0) return 1;
  return std::clamp(octaves - octave - std::log2(width), 0.0, 1.0);
}

}  // namespace wobblebench::sim
