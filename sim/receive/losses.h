// What a stick loses on its way, what interfaces send back, and what time gain restores.
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

/// Share of an interface's echo that is diffuse, 0 to 1.
double roughness(const phantoms::Material& before, const phantoms::Material& behind);

/// Echo of an interface as amplitude against a perfect mirror, before losses on the way. The two
/// parts of |R|: by roughness a diffuse part that falls as the cosine of incidence and arrives as
/// speckle (its mean), and the rest in a narrow Gaussian lobe about the normal, which arrives as
/// one pulse.
double diffuse_echo(const phantoms::Material& before,
                    const phantoms::Material& behind,
                    double cos_incidence);
double specular_echo(const phantoms::Material& before,
                     const phantoms::Material& behind,
                     double cos_incidence,
                     const SimulationOptions& options);

/// Time gain at a range, as an amplitude factor.
double time_gain(const hw::AcquisitionPlan& plan, const SimulationOptions& options, double range_m);

/// Amplitude at the face below which nothing shows, however strong its reflector: 20 dB under the
/// noise, or under the bottom of the dynamic range. 0: everything shows.
double lost_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

/// What is left on the way, and where the scanner believes to be. Samples lie at the apparent
/// ranges (i + 1/2) * spacing_m.
class StickLosses {
 public:
  StickLosses(const hw::AcquisitionPlan& plan,
              const SimulationOptions& options,
              const std::vector<phantoms::Material>& materials,
              double spacing_m,
              int samples);

  /// For one stick; reuses what the last one needed.
  void compute(const StickTrack& track);

  /// Two-way amplitude left at each sample: attenuation 2 alpha f d, and 1 - R^2 for each interface
  /// crossed there and back. Ends where everything is lost.
  const std::vector<float>& left() const { return left_; }
  /// Two-way amplitude that arrives at each interface of the track; 0 where everything was lost.
  const std::vector<double>& at_interface() const { return at_interface_; }
  /// Apparent less true range at each of left()'s samples; empty where sound has one speed.
  const std::vector<float>& delay_m() const { return delay_m_; }
  /// Apparent range of a true one.
  double apparent_m(const StickTrack& track, double true_m) const;
  /// Samples of a stick that lie before an apparent range.
  int samples_before(double range_m) const;

 private:
  /// What a material does to sound on its way.
  struct Medium {
    double speed_ratio = 1;    ///< assumed speed over its own
    double nepers_per_m = 0;   ///< of apparent range, there and back
    double left_a_sample = 1;  ///< of the amplitude
  };

  const Medium& medium(phantoms::MaterialIndex material) const {
    return media_.at(static_cast<std::size_t>(material));
  }
  double transmission(const Interface& crossed) const;
  /// Appends the samples of a stretch up to sample `end`, and ends them where all is lost.
  void fade(const Medium& medium, double level, double from_m, int end);
  void append_delays(const Stretch& stretch, double from_m);

  const std::vector<phantoms::Material>* materials_;
  SimulationOptions options_;
  std::vector<Medium> media_;  ///< of each material
  double spacing_m_;
  int samples_;
  double lost_;
  std::vector<float> left_;
  std::vector<double> at_interface_;
  std::vector<float> delay_m_;
  std::vector<double> apparent_from_m_;  ///< of each stretch
};

}  // namespace wobblebench::sim
