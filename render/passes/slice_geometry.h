// Where slices lie: the Cartesian grid of pass 1 and the cone of valid data, shared by the GL
// passes and the reference because both define what is rendered.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/options.h"
#include "render/passes/region.h"

namespace wobblebench::render {

/// Where a place of the probe frame lies in the stack of slices.
struct SlicePoint {
  double across_m = 0;  ///< x = r sin(theta), in the image plane
  double depth_m = 0;   ///< r cos(theta), from the centre of curvature
  double frame = 0;     ///< frame index, fractional between frames
  bool inside = false;  ///< of the cone of valid data
};

/// A slice shows its image plane in the coordinates x = r sin(theta) and depth r cos(theta), where
/// r = radius of the face + range. Its pixels tile the tight bounding box of the sector:
/// x in [-R sin(s/2), R sin(s/2)], depth in [a cos(s/2), R] for sector s, a <= r <= R.
/// The cone of valid data is 0 <= range <= depth, |theta| <= s/2 and the fan between the first and
/// the last frame. A lone stick fills its sector, a lone frame its fan.
///
/// Where the motor turns while a frame is taken, its sticks lie on a surface askew to the plane: a
/// place's frame index then depends on its theta too (frame_skew).
class SliceGeometry {
 public:
  SliceGeometry(const hw::AcquisitionPlan& plan, int slice_size);

  double x_max_m() const { return x_max_m_; }
  double depth_min_m() const { return depth_min_m_; }
  double depth_max_m() const { return r_max_m_; }
  double r_min_m() const { return r_min_m_; }
  double r_max_m() const { return r_max_m_; }
  double half_sector_rad() const { return half_sector_rad_; }
  double axis_z_m() const { return axis_z_m_; }
  int slice_size() const { return slice_size_; }
  int frames() const { return frames_; }

  double pixel_x_m(double column) const;
  double pixel_depth_m(double row) const;
  /// Fractional pixel of a place, 0 at the first pixel's middle.
  double column(double x_m) const;
  double row(double depth_m) const;

  /// Frame index at a motor angle and theta = 0; the middle frame's where there is only one.
  double frame_at(double phi_rad) const;
  /// By how many frames a stick lies further than its frame's middle, for each radian of theta, in
  /// a volume that is swept in this direction (hw::AcquisitionPlan::sweep_direction): the index of
  /// a place is frame_at(phi) - frame_skew(sweep) theta. 0 for the stepped motor.
  double frame_skew(int sweep) const;
  bool is_skewed() const { return frame_skew(1) != 0; }
  /// Motor angles between which the cone lies.
  double phi_min_rad() const { return phi_min_rad_; }
  double phi_max_rad() const { return phi_max_rad_; }

  /// Fractional line and sample of a place in the image plane, clamped to those that exist;
  /// `inside` tells whether it lies in the sector.
  struct PolarIndex {
    double line = 0;
    double sample = 0;
    bool inside = false;
  };
  PolarIndex polar_index(double x_m, double depth_m) const;

  /// Closed form of what the LUTs of passes 1 and 2 hold.
  SlicePoint locate(const glm::dvec3& position_m, int sweep = 1) const;

 private:
  hw::AcquisitionPlan plan_;
  int slice_size_;
  int frames_;
  double axis_z_m_, r_min_m_, r_max_m_, half_sector_rad_;
  double x_max_m_, depth_min_m_;
  double phi_min_rad_, phi_max_rad_;
};

/// A box around the whole cone of valid data: where rays end that do not end at the volume of
/// interest.
VolumeOfInterest field_box(const SliceGeometry& geometry);

/// Pixels of a slice that a trilinear fetch within this margin of the box reads, in any frame.
Region pixels_within(const SliceGeometry& geometry, const VolumeOfInterest& box, double margin_m);

/// Pass 1's LUT: for each pixel, line, sample and 1 inside the sector, else three zeros. `pixels`
/// may reach beyond the slice, where there is nothing.
std::vector<float> make_polar_table(const SliceGeometry& geometry, const Region& pixels);

/// Pass 2's LUT for the motion direction: over (y, z) of the probe frame, the in-plane depth, the
/// frame index, and a flag that is 1 wherever a bilinear fetch in the cone reads from. Near the
/// cone's border the flag is generous: users test depth and frame too.
struct MotionTable {
  double y_min_m = 0, y_max_m = 0;  ///< places of the first and last entries
  double z_min_m = 0, z_max_m = 0;
  int size = 0;               ///< entries a side, y fastest
  std::vector<float> values;  ///< depth_m, frame, flag
};
MotionTable make_motion_table(const SliceGeometry& geometry, int size);

/// Entries a side of pass 2's LUT. At the paper's settings a bilinear fetch is then within 1e-6 m
/// and 1e-3 frames of the closed form (slice_geometry_test).
inline constexpr int kMotionTableSize = 1024;

}  // namespace wobblebench::render
