// Bounds of many similar conditions.
#pragma once

#include <array>
#include <map>
#include <vector>

#include "bench/evaluation/bound/detection_bound.h"

namespace wobblebench::bench {

/// Conditions are brought onto a grid: 5 % of the rise's width, 1 dB of the tissue's echo, a tenth
/// of the number of sticks within the beam.
class BoundTable {
 public:
  /// Of sticks that share pulse, sampling, noise and clutter with these conditions.
  explicit BoundTable(const DetectionConditions& like) : like_(like) {}

  using Entry = std::size_t;
  /// Not to be called after compute().
  Entry add(const DetectionConditions& conditions);
  /// On all threads; throws std::invalid_argument as detection_bound_m().
  void compute();
  double bound_m(Entry entry) const { return bounds_[entry]; }
  std::size_t size() const { return entries_.size(); }

 private:
  /// Steps of rise, echo, line and frame density.
  using Key = std::array<int, 4>;
  DetectionConditions conditions_of(const Key& key) const;

  DetectionConditions like_;
  std::map<Key, Entry> entries_;
  std::vector<Key> keys_;
  std::vector<double> bounds_;
};

}  // namespace wobblebench::bench
