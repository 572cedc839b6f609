// One-way losses of all sticks of a volume, at a few depths.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/losses/losses.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// Sticks and depths of a table; node k lies at range k * step_m.
struct LossGrid {
  int frames = 1;
  int lines = 1;
  int nodes = 2;
  double step_m = 0;

  /// About 8 mm per step, at most 64 steps.
  static LossGrid of(const hw::AcquisitionPlan& plan, double depth_m);
};

/// For each node, frame and line: the amplitude that reaches the node at the centre frequency, its
/// product with the nepers absorbed up to there, and the material. The first two are interpolated
/// between sticks.
class LossTable {
 public:
  explicit LossTable(const LossGrid& grid);

  /// Several threads may record sticks at the same time.
  void record(int frame, int line, const StickTrack& track, const TissueLosses& losses);
  /// Computes the bounds of a frame's losses when all its sticks have been recorded.
  void finish(int frame);

  /// Values of a node, [frame][line].
  const float* transmitted(int node) const { return transmitted_.data() + plane(node); }
  const float* absorbed(int node) const { return absorbed_.data() + plane(node); }
  const float* material(int node) const { return material_.data() + plane(node); }
  /// True if sticks of these frames lose different amounts between a node and the next one.
  bool differs(int node, int first_frame, int last_frame) const;

 private:
  /// Smallest and largest ratio of the amplitudes at two successive nodes, over the lines of a
  /// frame.
  struct Bounds {
    float low;
    float high;
  };

  std::size_t plane(int node) const {
    return static_cast<std::size_t>(node) * static_cast<std::size_t>(grid_.frames * grid_.lines);
  }
  std::size_t at(int node, int frame, int line) const {
    return plane(node) + static_cast<std::size_t>(frame * grid_.lines + line);
  }
  void store(std::size_t at, double transmitted, double nepers);
  Bounds bounds(int node, int frame) const;

  LossGrid grid_;
  std::vector<float> transmitted_;
  std::vector<float> absorbed_;
  std::vector<float> material_;  ///< index; float, for vectorised loops
  std::vector<Bounds> bounds_;   ///< [frame][node]
};

}  // namespace wobblebench::sim
