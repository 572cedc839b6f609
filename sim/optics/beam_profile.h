// Widths and levels of the beam by range and by the stick's angle, on a coarse grid.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/optics/probe_optics.h"

namespace wobblebench::sim {

/// Ranges and stick angles at which slowly varying functions of both are tabulated.
class BeamGrid {
 public:
  /// At most the given steps, within limits of the grid's size.
  BeamGrid(const hw::AcquisitionPlan& plan, double range_step_m, double angle_step_rad);

  int ranges() const { return ranges_; }
  int angles() const { return angles_; }
  double range_m(int i) const { return (i + 0.5) * range_step_m_; }
  double angle_rad(int i) const { return i * angle_step_rad_; }

  /// The two grid lines around a value, and the weight of the second; constant beyond the ends.
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

/// ProbeOptics::profile() is the one of a scene.
class BeamProfile {
 public:
  explicit BeamProfile(const ProbeOptics& optics);

  /// Two-way -6 dB width of the peak of a scatterer's echo from stick to stick.
  double lateral_fwhm_m(double range_m, double theta_rad = 0) const;
  /// The same from frame to frame.
  double elevation_fwhm_m(double range_m) const;
  /// The product of the three -6 dB widths on the middle stick.
  double resolution_cell_m3(double range_m) const;
  /// Echo amplitude of uniform tissue relative to the middle stick's at the same range: towards the
  /// end of the array the aperture shrinks.
  double level(double range_m, double theta_rad) const;

 private:
  struct Entry {
    double lateral_fwhm_m;
    double elevation_fwhm_m;  ///< valid at angle 0
    /// Cube root of the echo power of uniform tissue, not normalised. It is nearly proportional to
    /// the fraction of the aperture on the array, which falls linearly with the angle.
    double power_root;
  };
  void measure(const ProbeOptics& optics, int range);
  double interpolate(double range_m, double theta_rad, double Entry::*value) const;

  BeamGrid grid_;
  std::vector<Entry> entries_;  ///< [range][angle]
  double axial_fwhm_m_;
};

struct BeamAtSample {
  float lateral2 = 0;  ///< squared standard deviation of the two-way power
  float elevation2 = 0;
  float level2 = 1;  ///< echo power of uniform tissue relative to the middle stick's
};

/// Width and level of the beam at each sample of a stick, for sticks at closely spaced angles;
/// sample i lies at range (i + 1/2) * spacing_m.
class BeamAtSamples {
 public:
  BeamAtSamples(const hw::AcquisitionPlan& plan,
                const BeamProfile& profile,
                double spacing_m,
                int samples);

  /// The samples of a stick.
  const BeamAtSample* of(double theta_rad) const;

 private:
  int samples_;
  double angle_step_rad_;
  int angles_;
  std::vector<BeamAtSample> table_;  ///< [angle][sample]
};

}  // namespace wobblebench::sim
