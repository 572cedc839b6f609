// Widths and levels of the beam by range and by the stick's angle, on a coarse grid.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/optics/pulse_band.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// Ranges and angles of sticks at which slow functions of both are tabulated.
class BeamGrid {
 public:
  /// At most the given steps, within limits of the grid's size.
  BeamGrid(const hw::AcquisitionPlan& plan, double range_step_m, double angle_step_rad);

  int ranges() const { return ranges_; }
  int angles() const { return angles_; }
  double range_m(int i) const { return (i + 0.5) * range_step_m_; }
  double angle_rad(int i) const { return i * angle_step_rad_; }

  /// The two grid lines about a value, and the share of the second; constant beyond the ends.
  struct Between {
    std::size_t first;
    std::size_t second;
    double share;
  };
  Between range_at(double range_m) const;
  /// For the magnitude of the angle.
  Between angle_at(double theta_rad) const;

 private:
  int ranges_;
  int angles_;
  double range_step_m_;
  double angle_step_rad_;
};

class BeamProfile {
 public:
  BeamProfile(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

  /// Two-way -6 dB widths of the peak of a scatterer's echo as sticks or frames turn past it.
  double lateral_fwhm_m(double range_m, double theta_rad = 0) const;
  double elevation_fwhm_m(double range_m) const;
  /// The product of the three -6 dB widths on the middle stick.
  double resolution_cell_m3(double range_m) const;
  /// Echo amplitude of even tissue over that of the middle stick at the same range: towards the end
  /// of the array the aperture shrinks.
  double level(double range_m, double theta_rad) const;

 private:
  struct Entry {
    double lateral_fwhm_m;
    double elevation_fwhm_m;  ///< that of angle 0 counts
    /// Cube root of the power of even tissue's echo, not normalised: nearly in proportion to what
    /// the array's end leaves of the aperture, which falls evenly with the angle.
    double power_root;
  };
  void measure(int range);
  double interpolate(double range_m, double theta_rad, double Entry::*value) const;

  hw::AcquisitionPlan plan_;
  Apodisation apodisation_;
  PulseBand band_;
  BeamGrid grid_;
  std::vector<Entry> entries_;  ///< [range][angle]
  double axial_fwhm_m_;
};

}  // namespace wobblebench::sim
