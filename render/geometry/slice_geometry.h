// Geometry of the slices: the scan that they are made of, the Cartesian grid of pass 1 and the cone
// of valid data, for the GL passes and the double-precision reference.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/gl/texels.h"
#include "render/options.h"

namespace wobblebench::render {

/// Steps between sticks and between frames of the denser scan for one of the real scan.
struct DenseFactors {
  int lines = 1, frames = 1;
};

/// The least factors for which neighbours lie within ReconstructionOptions::spacing_m at the far
/// side of the box; no more than 8, and no more sticks or frames than a plan may have. 1 for plain
/// sticks.
DenseFactors dense_factors(const hw::AcquisitionPlan& plan, const RenderOptions& options);

/// The scan that slices are made of: the sticks of a scan and those that are put between them, over
/// the same sector and fan.
hw::AcquisitionPlan dense_plan(const hw::AcquisitionPlan& plan, const DenseFactors& factors);

/// A part of the fan, as fractional frame indices.
struct FrameSpan {
  double first = 0, last = 0;

  bool holds(double frame) const { return frame >= first && frame <= last; }
};

/// Slice coordinates of a position in the probe frame.
struct SlicePoint {
  double x_m = 0;       ///< r sin(theta), in the image plane
  double depth_m = 0;   ///< r cos(theta), from the centre of curvature
  double frame = 0;     ///< frame index, fractional between frames
  bool inside = false;  ///< in the cone of valid data
};

/// A slice is an image plane in the coordinates x = r sin(theta) and depth r cos(theta), where
/// r = radius of the face + range. Its pixels tile the tight bounding box of the sector:
/// x in [-R sin(s/2), R sin(s/2)], depth in [a cos(s/2), R] for sector s, a <= r <= R.
/// The cone of valid data is 0 <= range <= depth, |theta| <= s/2 and the fan between the first and
/// the last frame. A single stick fills its sector, a single frame its fan.
///
/// If the motor turns while a frame is acquired, its sticks lie on a surface skewed against the
/// plane: the frame index of a position then depends on theta too (frame_skew).
class SliceGeometry {
 public:
  /// `factors`: of the denser scan that the slices are made of; its lines and frames are counted.
  SliceGeometry(const hw::AcquisitionPlan& plan, int slice_size, const DenseFactors& factors = {});

  double x_max_m() const { return x_max_m_; }
  double depth_min_m() const { return depth_min_m_; }
  double depth_max_m() const { return r_max_m_; }
  double r_min_m() const { return r_min_m_; }
  double r_max_m() const { return r_max_m_; }
  double half_sector_rad() const { return half_sector_rad_; }
  double axis_z_m() const { return axis_z_m_; }
  int slice_size() const { return slice_size_; }
  int frames() const { return frames_; }
  /// DenseFactors::frames.
  int frames_per_planned_frame() const { return frames_per_planned_frame_; }

  /// Coordinates of a fractional pixel, 0 at the first pixel's centre.
  double pixel_x_m(double column) const;
  double pixel_depth_m(double row) const;
  /// The inverse.
  double column(double x_m) const;
  double row(double depth_m) const;

  /// Frame index at a motor angle and theta = 0; 0 if there is only one frame.
  double frame_at(double phi_rad) const;
  /// Offset of a stick from its frame's middle, in frames per radian of theta, for a sweep in this
  /// direction (hw::AcquisitionPlan::sweep_direction): a position has the frame index
  /// frame_at(phi) - frame_skew(sweep) theta. 0 for the stepped motor.
  double frame_skew(int sweep) const;
  bool is_skewed() const { return frame_skew(1) != 0; }
  /// Motor angles that bound the cone.
  double phi_min_rad() const { return phi_min_rad_; }
  double phi_max_rad() const { return phi_max_rad_; }

  /// Fractional line and sample of a position in the image plane, clamped to those that exist;
  /// `inside`: in the sector.
  struct PolarIndex {
    double line = 0;
    double sample = 0;
    bool inside = false;
  };
  PolarIndex polar_index(double x_m, double depth_m) const;

  /// Slice coordinates in closed form; the LUT of pass 2 tabulates them.
  SlicePoint locate(const glm::dvec3& position_m, int sweep = 1) const;

 private:
  hw::AcquisitionPlan plan_;
  int slice_size_;
  int frames_, frames_per_planned_frame_;
  double frame_skew_;  ///< for a sweep in the direction +1
  double axis_z_m_, r_min_m_, r_max_m_, half_sector_rad_;
  double x_max_m_, depth_min_m_;
  double phi_min_rad_, phi_max_rad_;
};

/// A box around the whole cone of valid data; rays end there if stop_at_box is false.
VolumeOfInterest field_box(const SliceGeometry& geometry);

/// Pixels of a slice that a trilinear fetch within this margin of the box reads, in any frame.
Region pixels_within(const SliceGeometry& geometry, const VolumeOfInterest& box, double margin_m);

/// LUT of pass 1 (paper section 3.1): per pixel, line, sample and the flag 1 inside the sector,
/// else three zeros. `pixels` may extend beyond the slice, where the flag is 0.
std::vector<float> make_polar_table(const SliceGeometry& geometry, const Region& pixels);

/// LUT of pass 2 for the motion direction (paper section 3.2): over (y, z) of the probe frame, the
/// in-plane depth, the frame index, and a flag that is 1 in all entries that a bilinear fetch in
/// the cone reads. Near the cone's border it is 1 outside too: users test depth and frame as well.
struct MotionTable {
  double y_min_m = 0, y_max_m = 0;  ///< of the first and last entries
  double z_min_m = 0, z_max_m = 0;
  int size = 0;               ///< entries per side, y fastest
  std::vector<float> values;  ///< depth_m, frame, flag
};
MotionTable make_motion_table(const SliceGeometry& geometry, int size);

/// Entries per side of the LUT of pass 2. At the paper's settings a bilinear fetch is then within
/// 1e-6 m and 1e-3 frames of the closed form (slice_geometry_test).
inline constexpr int kMotionTableSize = 1024;

/// Mode fast: consecutive layers of the volume texture that are made together, out of `count` + 1
/// slices.
struct LayerGroup {
  int first = 0;
  int count = 0;
};

/// Groups that a draw makes at most: enough to hide its fixed cost.
inline constexpr int kGroupsPerBatch = 6;

}  // namespace wobblebench::render
