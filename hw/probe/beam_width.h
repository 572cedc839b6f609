// How wide the beam of a probe is, from its aperture alone.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::hw {

/// Two-way -6 dB widths of a point's echo, metres.
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
