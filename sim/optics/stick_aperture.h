// The elements of the probe as one stick uses them: places, weights and delays.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// An element in beam coordinates, in the image plane.
struct Element {
  double axial_m;
  double lateral_m;
  double angle_rad;  ///< of its normal, from the stick towards +lateral
};

/// An aperture is as long along the face as its focus's range over the F-number: so many elements
/// are switched on, those partly within it weighted by that share. It ends with the array: at the
/// edge of a sector that the array just spans, half of it is missing.
class StickAperture {
 public:
  StickAperture(const hw::AcquisitionPlan& plan, Apodisation apodisation, double theta_rad);

  const std::vector<Element>& elements() const { return elements_; }
  /// False where the array ends within the apertures that serve a range.
  bool whole(double range_m) const;
  /// Weight of an element on transmit, for the focus that serves a range, and on receive with the
  /// focus at that range.
  double transmit_weight(const Element& element, double range_m) const;
  double receive_weight(const Element& element, double range_m) const;
  /// By which the way from an element to a focus on the axis is longer than the focus's range.
  static double excess_m(const Element& element, double focus_m);

 private:
  double weight(const Element& element, double aperture_m) const;

  hw::AcquisitionPlan plan_;
  Apodisation apodisation_;
  std::vector<Element> elements_;
};

/// The lens: point sources across the image plane at most half a wavelength apart, and the way that
/// the lens adds to each.
struct ElevationSources {
  std::vector<double> height_m;
  std::vector<double> lens_m;

  explicit ElevationSources(const hw::AcquisitionPlan& plan);
};

}  // namespace wobblebench::sim
