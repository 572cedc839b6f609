// Scatterers of one stick, collected into batches, turned into echoes and summed into range bins.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/speckle/scatterers/range_bins.h"
#include "sim/speckle/scatterers/stream_compaction.h"

namespace wobblebench::sim {

struct CrossedInterface;
struct ScattererScene;
struct StickBeam;
struct StickPath;

/// Farthest range whose echoes reach a stick's last sample.
struct EchoRange {
  double apparent_m;
  double true_m;

  EchoRange(const ScattererScene& scene, const StickPath& path);
};

/// Holds the working memory of one thread.
class EchoQueue {
 public:
  /// The arguments must outlive finish().
  void begin(const ScattererScene& scene, const StickPath& path);
  /// Memory for `count` scatterers, plus kCompactionWidth, to be filled before commit().
  ProjectedScatterers reserve(std::size_t count);
  /// Factor on an echo of an interface at a range that undoes the interface's own loss, which the
  /// bins apply. Moves the range by less than 0.01 samples, away from the ends of its bin.
  float front_gain(const CrossedInterface& interface, float& range_m) const;
  /// Appends the first `count` scatterers written to the reserved memory. Computes echoes when a
  /// batch is complete.
  void commit(int count);
  /// Adds all echoes to `iq`. Returns their number.
  std::uint64_t finish(std::span<std::complex<float>> iq);

 private:
  void make_echoes();
  void tabulate_delays();
  void add_delays();
  float delay_at(float range_m) const;

  const ScattererScene* scene_ = nullptr;
  const StickPath* path_ = nullptr;
  const StickBeam* beam_ = nullptr;
  std::vector<float> range_m_;
  std::vector<std::uint32_t> table_index_;
  std::vector<float> amplitude_;
  std::vector<float> delay_m_;  ///< at true ranges one sample apart; empty: no delay
  RangeBins bins_;
  std::size_t pending_ = 0;
  std::uint64_t total_ = 0;
};

}  // namespace wobblebench::sim
