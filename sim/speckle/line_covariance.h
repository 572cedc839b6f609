// How speckle correlates between the lines of a frame.
//
// Lines hear the same scatterers with different phases: the covariance of their fields is the
// overlap of their two-way responses, the sum over places and frequencies of h1 conj(h2). Out of
// focus a beam is wide but its phase is curved, so that speckle stays as fine as the aperture makes
// it (the van Cittert-Zernike theorem, docs/references.md [21]). Towards the array's end each line
// has an aperture of its own.
#pragma once

#include <vector>

#include "sim/optics/stick_aperture.h"
#include "sim/speckle/banded_matrix.h"

namespace wobblebench::sim {

/// Sticks of one frame, evenly spaced.
struct EvenLines {
  int count;
  double first_rad;
  double step_rad;  ///< more than 0 where there are several

  /// All of a frame's.
  static EvenLines of(const hw::AcquisitionPlan& plan);
  /// The fewest over the same sector between which speckle can be interpolated; all of them where
  /// there are no more.
  static EvenLines needed(const hw::AcquisitionPlan& plan);
};

class LineCovariance {
 public:
  LineCovariance(const hw::AcquisitionPlan& plan, Apodisation apodisation, const EvenLines& lines);

  /// The real part of the covariance of fields of unit power at a range. The phase of a whole line
  /// is not seen: phases are such that neighbours' covariance is real. A line that no element
  /// serves correlates with no other.
  BandedMatrix at(double range_m) const;

 private:
  hw::AcquisitionPlan plan_;
  Apodisation apodisation_;
  EvenLines lines_;
  std::vector<StickAperture> apertures_;  ///< of each line
};

}  // namespace wobblebench::sim
