// How wide the beam of a probe is, from its aperture alone.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::hw {

/// False with 0 elements, of scans whose aperture is not known: pitch, F-number and transmit focus
/// then say nothing, and without a lens neither does the frequency. Options that a user gives
/// cannot say it.
constexpr bool knows_array(const ProbeOptions& probe) {
  return probe.elements != 0;
}
/// False with an element height of 0, likewise across the image plane.
constexpr bool knows_lens(const ProbeOptions& probe) {
  return probe.element_height_m != 0;
}

/// As validate(), but for an aperture that is not known.
void validate_known(const ProbeOptions& probe);

/// The probe with the aperture of `other` where its own is not known.
ProbeOptions with_aperture_of(const ProbeOptions& probe, const ProbeOptions& other);

/// Two-way -6 dB widths of a point's echo, metres; 0 where the aperture is not known.
struct BeamWidth {
  double lateral_m = 0;    ///< from stick to stick
  double elevation_m = 0;  ///< from frame to frame
};

/// At this range on the middle stick: transmit times receive field of the elements along the face
/// and of the lens across them, summed over sources and over the pulse's band (docs/references.md
/// [27]). The apertures are those of sim::ProbeOptics, not apodised; with focal zones the transmit
/// focus is still the probe's. Attenuation, which lowers the frequency with depth, is left out.
/// Throws std::invalid_argument unless the range is above 0.
BeamWidth beam_width(const AcquisitionPlan& plan, double range_m);

/// Those widths over the depth of a plan, interpolated linearly between kRows ranges.
class BeamWidths {
 public:
  static constexpr int kRows = 20;

  explicit BeamWidths(const AcquisitionPlan& plan);

  /// Beyond the ends the width there.
  BeamWidth at(double range_m) const;

  /// Range of the first and of the last row.
  double first_m() const { return first_m_; }
  double last_m() const { return last_m_; }
  const std::vector<BeamWidth>& rows() const { return rows_; }

 private:
  double first_m_, last_m_;
  std::vector<BeamWidth> rows_;
};

}  // namespace wobblebench::hw
