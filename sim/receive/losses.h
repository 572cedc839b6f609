// Two-way losses along a stick, reflection at interfaces, and time-gain compensation (TGC).
#pragma once

#include <cmath>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/material.h"
#include "sim/options.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

inline double amplitude_of_db(double db) {
  return std::pow(10.0, db / 20);
}

/// Amplitude reflection of a plane wave at an interface between fluids, by impedance and angle:
/// (Z2 cos i - Z1 cos t) / (Z2 cos i + Z1 cos t), sin t = (c2 / c1) sin i; 1 beyond the critical
/// angle. Shear waves in bone are not modelled.
double reflection(const phantoms::Material& before,
                  const phantoms::Material& behind,
                  double cos_incidence);

/// Diffuse fraction of an interface's echo, 0 to 1.
double roughness(const phantoms::Material& before, const phantoms::Material& behind);

/// Amplitude of an interface's echo relative to a perfect mirror, without losses on the way. |R| is
/// divided by roughness: the diffuse part is proportional to the cosine of incidence and becomes
/// speckle (this is its mean); the specular part has a narrow Gaussian lobe about the normal and
/// becomes one pulse.
double diffuse_echo(const phantoms::Material& before,
                    const phantoms::Material& behind,
                    double cos_incidence);
double specular_echo(const phantoms::Material& before,
                     const phantoms::Material& behind,
                     double cos_incidence,
                     const SimulationOptions& options);

/// TGC at a range, as an amplitude factor.
double time_gain(const hw::AcquisitionPlan& plan, const SimulationOptions& options, double range_m);

/// Amplitude at the face below which an echo is invisible: 20 dB below the noise, or without noise
/// below the dynamic range. 0: every echo is visible.
double visible_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

/// The amplitude that remains along a stick, and the apparent ranges: those that the scanner
/// computes from the time of flight with its one sound speed. Samples lie at the apparent ranges
/// (i + 1/2) * spacing_m. Holds the working memory of one thread.
class StickLosses {
 public:
  /// `materials` must outlive it.
  StickLosses(const hw::AcquisitionPlan& plan,
              const SimulationOptions& options,
              const std::vector<phantoms::Material>& materials,
              double spacing_m,
              int samples);

  /// Reuses the memory of the stick before.
  void compute(const StickTrack& track);

  /// Two-way amplitude that remains at each sample: attenuation 2 alpha f d, and 1 - R^2 for each
  /// interface crossed there and back. Ends where an echo is invisible.
  const std::vector<float>& remaining() const { return remaining_; }
  /// Two-way amplitude that remains at each interface of the track; 0 beyond the last sample.
  const std::vector<double>& at_interface() const { return at_interface_; }
  /// Apparent minus true range at each sample of remaining(); empty where sound has one speed.
  const std::vector<float>& delay_m() const { return delay_m_; }
  /// Apparent range of a true range.
  double apparent_m(const StickTrack& track, double true_m) const;
  /// Number of samples that lie before an apparent range.
  int samples_before(double range_m) const;

 private:
  struct Medium {
    double speed_ratio = 1;        ///< assumed speed over the material's
    double nepers_per_m = 0;       ///< two-way attenuation per apparent range
    double factor_per_sample = 1;  ///< of the amplitude
  };

  const Medium& medium(phantoms::MaterialIndex material) const {
    return media_.at(static_cast<std::size_t>(material));
  }
  double transmission(const Interface& crossed) const;
  /// Appends samples up to `end`, or to the first invisible one. `level`: amplitude at `from_m`.
  void append_decay(const Medium& medium, double level, double from_m, int end);
  void append_delays(const Stretch& stretch, double from_m);

  const std::vector<phantoms::Material>* materials_;
  SimulationOptions options_;
  std::vector<Medium> media_;  ///< of each material
  double spacing_m_;
  int samples_;
  double visible_;
  std::vector<float> remaining_;
  std::vector<double> at_interface_;
  std::vector<float> delay_m_;
  std::vector<double> apparent_from_m_;  ///< of each stretch
};

}  // namespace wobblebench::sim
