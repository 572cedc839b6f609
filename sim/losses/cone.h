// The ways from the aperture to points on a stick, as distances among the sticks of a volume.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/losses/loss_table.h"

namespace wobblebench::sim {

/// A way starts in the middle of one of the aperture's kLateral equal parts along the face and of
/// one of its kElevation equal parts across the image plane, and is straight. Its distance from the
/// axis at a depth is an angle about the face's centre of curvature, or about the motor's axis.
class ApertureCone {
 public:
  static constexpr int kLateral = 8;
  static constexpr int kElevation = 4;
  /// Transmit and receive.
  static constexpr int kEnds = 2;

  ApertureCone(const hw::AcquisitionPlan& plan, const LossGrid& grid);

  /// Distance of a part's way from the axis, in lines, between nodes `from` and `from` + 1 on the
  /// way to node `to`.
  float lines_aside(int end, int part, int from, int to) const {
    return lines_aside_[at(end, to, from) * kLateral + static_cast<std::size_t>(part)];
  }
  /// The same across the image plane, in metres.
  double elevation_m(int part, int from, int to) const;
  /// Frames for each metre across the image plane between node `from` and the next, on each line.
  const float* frames_per_m(int from) const {
    return frames_per_m_.data() + static_cast<std::size_t>(from * grid_.lines);
  }
  /// Most frames that a way lies aside between node `from` and the next.
  int most_frames(int from) const { return most_frames_[static_cast<std::size_t>(from)]; }
  /// Most lines that any way lies aside.
  int most_lines() const;

  /// Share of a part of the aperture for a node that lies on the array, for each line. At least one
  /// part's is positive.
  const float* on_array(int end, int part, int node) const {
    const int row = (end * grid_.nodes + node) * kLateral + part;
    return on_array_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(grid_.lines);
  }

 private:
  std::size_t at(int end, int to, int from) const {
    return static_cast<std::size_t>((end * grid_.nodes + to) * grid_.nodes + from);
  }
  /// Share of a way's distance from the axis at its start, which lies `behind_m` behind the face's
  /// middle, that is left between node `from` and the next.
  double left(int from, int to, double behind_m) const;
  void place_frames(const hw::AcquisitionPlan& plan);
  void place(double aperture_m, int to);
  void weigh(double aperture_m);
  float share_on_array(double from_rad, double to_rad) const;

  hw::ProbeOptions probe_;
  LossGrid grid_;
  double lines_per_rad_;
  double array_rad_;                 ///< angle of the last element
  double widest_m_ = 0;              ///< of the apertures
  std::vector<double> theta_rad_;    ///< of each line
  std::vector<float> frames_per_m_;  ///< [node][line]
  std::vector<int> most_frames_;     ///< [node]
  std::vector<float> lines_aside_;   ///< [end][to][from][part]
  std::vector<float> on_array_;      ///< [end][node][part][line]
};

}  // namespace wobblebench::sim
