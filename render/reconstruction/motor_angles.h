// Where the frames of a volume lie by the motor angles of their sticks, where these are not those
// of the plan: a motor that accelerates, has an offset or a backlash.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "hw/probe/polar_volume.h"
#include "render/geometry/slice_geometry.h"

namespace wobblebench::render {

/// Where a stick that was not fired lies among those of its line that were.
struct FramePlace {
  std::array<int, 4> frames{};  ///< neighbours in ascending order of angle, two on each side
  double t = 0;                 ///< between the middle two, 0 to 1
  double step_rad = 0;          ///< from one of the middle two to the other
};

/// Step `i` of `factor` steps from one of `count` frames (or lines) to the next, `step_rad` apart.
FramePlace regular_place(int i, int factor, int count, double step_rad);

/// The frames of one line in ascending order of their motor angles.
class FrameOrder {
 public:
  explicit FrameOrder(std::vector<std::pair<double, int>> angles_and_frames);
  /// Beyond the first and last frame: that frame.
  FramePlace at(double phi_rad) const;

 private:
  std::vector<std::pair<double, int>> sorted_;
};

/// The motor angles of a volume.
struct MotorAngles {
  std::vector<double> phi_rad;  ///< [frame * lines + line]; empty: those of the plan
  /// The part of the fan that sticks of all lines cover.
  FrameSpan covered;

  bool as_planned() const { return phi_rad.empty(); }
  /// At a line, which may lie between two. Not for as_planned().
  FrameOrder order_at(double line, int lines) const;
};

/// Motor angle at which dense_plan() places a stick; the motor turns in the direction +1.
double dense_angle_rad(const hw::AcquisitionPlan& plan,
                       const DenseFactors& factors,
                       int frame,
                       int line);

/// The frames of the plan, each stick interpolated linearly between those of its line whose motor
/// angles lie around the plan's. Not for MotorAngles::as_planned().
std::vector<std::vector<float>> place_frames(const hw::AcquisitionPlan& plan,
                                             const std::vector<std::vector<float>>& received,
                                             const MotorAngles& angles);

/// Collects the motor angles of frames as they come.
class ReceivedAngles {
 public:
  explicit ReceivedAngles(const hw::AcquisitionPlan& plan);

  void put(int frame, const hw::PolarFrame& samples);
  /// A lost stick deviates from the plan as its neighbours do, first those of its frame. Angles
  /// whose deviation is negligible (hw/probe/motor_deviation.h) are the plan's, in either direction
  /// of the sweep.
  MotorAngles angles() const;

 private:
  hw::AcquisitionPlan plan_;
  std::size_t frames_, lines_;
  std::vector<double> deviation_rad_;      ///< [frame * lines + line]; NaN: not known
  std::vector<std::uint8_t> leaves_plan_;  ///< per frame
};

}  // namespace wobblebench::render
