// Point scatterers beside a phantom's tissue: fixed in it, or on tracks through it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace wobblebench::phantoms {

/// A point that echoes.
struct PointScatterer {
  glm::dvec3 position_m{0};  ///< phantom frame at rest; the phantom's motion carries it
  /// Amplitude of the echo on the axis of a beam at the point's own range, without losses on the
  /// way: 1 is a perfect mirror's; negative: inverted.
  double amplitude = 0;

  friend bool operator==(const PointScatterer&, const PointScatterer&) = default;
};

/// Where a scatterer's track lies at one moment of device time.
struct ScattererKey {
  double time_s = 0;
  PointScatterer point;

  friend bool operator==(const ScattererKey&, const ScattererKey&) = default;
};

/// Scatterers with a track each. Between the keys of a track position and amplitude are linear in
/// time; before the first and after the last they stay. A track of one key is a fixed scatterer.
///
/// @code
/// #include <cstdio>
/// phantoms::PointScatterers points;
/// points.add({{0, 0, 0.05}, 0.01});
/// points.add_track({{0, {{0, 0, 0.06}, 0.01}}, {2, {{0.02, 0, 0.06}, 0.01}}});
/// std::printf("%g m", points.at(1, 0.5).position_m.x);  // 0.005 m
/// @endcode
class PointScatterers {
 public:
  void add(const PointScatterer& fixed);
  /// Throws std::logic_error unless there are keys and their times rise.
  void add_track(const std::vector<ScattererKey>& track);
  void add(const PointScatterers& more);

  bool empty() const { return first_.empty(); }
  std::size_t size() const { return first_.size(); }
  std::size_t keys() const { return keys_.size(); }  ///< number of keys of all tracks together
  bool fixed(std::size_t index) const { return track(index).size() == 1; }
  bool all_fixed() const { return keys() == size(); }
  std::span<const ScattererKey> track(std::size_t index) const;
  PointScatterer at(std::size_t index, double time_s) const;

  friend bool operator==(const PointScatterers&, const PointScatterers&) = default;

 private:
  std::vector<ScattererKey> keys_;
  std::vector<std::size_t> first_;  ///< key of each track
};

}  // namespace wobblebench::phantoms
