// Scatterers that a stick sees, on their way into its bins of echoes.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/stream_compaction.h"
#include "sim/scatterers/range_bins.h"
#include "sim/scatterers/scatterer_field.h"

namespace wobblebench::sim {

/// How far a stick hears.
struct HeardRange {
  double apparent_m;
  double true_m;

  HeardRange(const ScattererScene& scene, const StickPath& way);
};

/// Working memory of one thread.
class EchoQueue {
 public:
  /// What is given must outlive finish().
  void begin(const ScattererScene& scene, const StickPath& way);
  /// Where the next go: room for so many, and kFlagsTogether more.
  SeenScatterers room_for(std::size_t scatterers);
  /// Takes so many of what has been written there. Echoes are made as soon as there are enough.
  void take(int count);
  /// Adds all echoes to `iq`. Returns how many there were.
  std::uint64_t finish(std::span<std::complex<float>> iq);

 private:
  void make_echoes();
  void find_delays();
  void delay_paths();

  const ScattererScene* scene_ = nullptr;
  const StickPath* way_ = nullptr;
  std::vector<float> path_m_;
  std::vector<std::uint32_t> places_;
  std::vector<float> amplitude_;
  std::vector<float> delay_m_;  ///< by true range, a sample apart; empty: none
  RangeBins bins_;
  std::size_t pending_ = 0;
  std::uint64_t total_ = 0;
};

}  // namespace wobblebench::sim
