// Acoustics of a probe: wavelength, apertures, foci and lens, in one value that is made once of an
// acquisition plan and the simulation's options.
#pragma once

#include <memory>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/optics/pulse_band.h"
#include "sim/options.h"

namespace wobblebench::sim {

class BeamProfile;

/// The elevation lens: point sources across the image plane, at most half a wavelength apart.
struct ElevationSources {
  std::vector<double> height_m;  ///< position of each source
  std::vector<double> lens_m;    ///< path length that the lens adds to it

  explicit ElevationSources(const hw::AcquisitionPlan& plan);
};

/// How the probe of an acquisition plan transmits and receives. Everything that computes a beam
/// takes it instead of the plan, so that the pulse's band and the beam's profile are computed once
/// for a scene. Immutable, cheap to copy, and usable from several threads.
///
/// An aperture along the face is as long as its focal range divided by the F-number, limited by the
/// array. The receive aperture follows the range (dynamic focus); the transmit aperture is that of
/// the fixed focus of the range's focal zone.
class ProbeOptics {
 public:
  /// Uses the apodisation and the number of threads of the options.
  explicit ProbeOptics(const hw::AcquisitionPlan& plan, const SimulationOptions& options = {});

  const hw::AcquisitionPlan& plan() const { return constants_->plan; }
  const hw::ProbeOptions& probe() const { return plan().probe(); }
  Apodisation apodisation() const { return constants_->apodisation; }
  /// For parallel loops; results do not depend on it.
  int threads() const { return constants_->threads; }
  const PulseBand& band() const { return constants_->band; }
  const ElevationSources& lens() const { return constants_->lens; }
  /// Widths and levels of the beam. The first call computes them; copies share them.
  const BeamProfile& profile() const;

  /// At the pulse's centre frequency.
  double wavelength_m() const { return constants_->wavelength_m; }
  /// Full width of the pulse at half amplitude.
  double axial_fwhm_m() const { return constants_->axial_fwhm_m; }
  /// Samples of a stick at the IQ rate; sample i lies at range (i + 1/2) * iq_spacing_m().
  int iq_samples() const { return constants_->iq_samples; }
  double iq_spacing_m() const { return constants_->iq_spacing_m; }

  /// Focal range of the transmit event that serves a range.
  double transmit_focus_m(double range_m) const;
  double transmit_aperture_m(double range_m) const {
    return receive_aperture_m(transmit_focus_m(range_m));
  }
  double receive_aperture_m(double range_m) const;

 private:
  struct Constants {
    hw::AcquisitionPlan plan;
    Apodisation apodisation;
    int threads;
    PulseBand band;
    ElevationSources lens;
    double wavelength_m;
    double axial_fwhm_m;
    int iq_samples;
    double iq_spacing_m;
  };
  struct LazyProfile;

  std::shared_ptr<const Constants> constants_;
  std::shared_ptr<LazyProfile> profile_;
};

/// The receive aperture of ProbeOptics: range / F-number, limited by the array.
double receive_aperture_m(const hw::ProbeOptions& probe, double range_m);

/// An element in beam coordinates, in the image plane.
struct Element {
  double axial_m;
  double lateral_m;
  double angle_rad;  ///< of its normal, from the stick towards +lateral
};

/// The elements of the probe as one stick uses them: positions, weights and delays. Elements within
/// the aperture are switched on; those partly within it are weighted by that fraction. The aperture
/// ends with the array: half of it is missing at the edge of a sector that is as wide as the array.
class StickAperture {
 public:
  /// `theta_rad`: angle of the stick in the image plane.
  StickAperture(const ProbeOptics& optics, double theta_rad);

  const ProbeOptics& optics() const { return optics_; }
  const std::vector<Element>& elements() const { return elements_; }
  /// False where the array ends within the apertures that serve a range.
  bool whole(double range_m) const;
  /// Weight of an element on transmit, with the focus that serves a range.
  double transmit_weight(const Element& element, double range_m) const;
  /// Weight of an element on receive, with the focus at a range.
  double receive_weight(const Element& element, double range_m) const;
  /// Distance from an element to a focus on the axis, minus the focal range.
  static double excess_m(const Element& element, double focus_m);

 private:
  double weight(const Element& element, double aperture_m) const;

  ProbeOptics optics_;
  std::vector<Element> elements_;
};

}  // namespace wobblebench::sim
