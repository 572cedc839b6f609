// Reflection at interfaces, and absorption.
#pragma once

#include <vector>

#include "base/units.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/material.h"
#include "sim/options.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

/// Amplitude reflection of a plane wave at an interface between fluids, by impedance and angle:
/// (Z2 cos i - Z1 cos t) / (Z2 cos i + Z1 cos t), sin t = (c2 / c1) sin i; 1 beyond the critical
/// angle. Shear waves in bone are not modelled.
double reflection(const phantoms::Material& before,
                  const phantoms::Material& behind,
                  double cos_incidence);

/// Diffuse fraction of an interface's echo, 0 to 1.
double roughness(const phantoms::Material& before, const phantoms::Material& behind);

/// Amplitude of the diffuse part of an interface's echo relative to a perfect mirror, without
/// losses before it: roughness |R| times the cosine of incidence. It becomes speckle, of which this
/// is the mean.
double diffuse_echo(const phantoms::Material& before,
                    const phantoms::Material& behind,
                    double cos_incidence);
/// Amplitude of the specular part: (1 - roughness) |R|, within a narrow Gaussian lobe about the
/// normal. It becomes one pulse.
double specular_echo(const phantoms::Material& before,
                     const phantoms::Material& behind,
                     double cos_incidence,
                     const SimulationOptions& options);

/// Mean power of a Rayleigh envelope of mean 1; the material table gives mean envelopes.
inline constexpr double kPowerOfRayleighMean = 4 / kPi;

/// Two-way absorption at the centre frequency, in nepers of amplitude per metre of range.
double two_way_nepers_per_m(const hw::AcquisitionPlan& plan, double alpha_db_per_cm_mhz);

/// Attenuation of a pulse with a bandwidth: absorption grows with frequency, so that the pulse's
/// centre frequency falls.
///
/// A Gaussian amplitude spectrum of standard deviation s f0 about f0, which ends at kBandEnd f0, is
/// multiplied by exp(-n f / f0). Its integral, the peak of a flat response's echo, is then
///   exp(-n + n^2 s^2 / 2) Phi((1 - n s^2 - kBandEnd) / s) / Phi((1 - kBandEnd) / s),
/// where Phi is the normal distribution function. n is in nepers at f0 for the whole path, transmit
/// and receive. TissueGain adds what the beam does to the echo of tissue.
class BandLoss {
 public:
  /// Lower end of the band, relative to f0.
  static constexpr double kBandEnd = 0.2;
  /// Lower bound of frequency_ratio().
  static constexpr double kLowest = -1;

  explicit BandLoss(const hw::ProbeOptions& probe);

  /// log_gain() from `from` to `to` nepers: gain + (slope + curvature x) x, x = nepers - from.
  struct Piece {
    double from;
    double to;
    double gain;
    double slope;
    double curvature;

    double at(double nepers) const {
      return gain + (slope + curvature * (nepers - from)) * (nepers - from);
    }
  };

  /// Squared relative standard deviation of the spectrum.
  double variance() const { return variance_; }
  /// Natural logarithm of the echo's peak relative to that of a pulse of the single frequency f0.
  double log_gain(double nepers) const { return piece(nepers).at(nepers); }
  /// The piece of log_gain() that contains a loss.
  const Piece& piece(double nepers) const;
  /// 1 - n s^2: the centre, relative to f0, of the Gaussian of which the spectrum is the part above
  /// kBandEnd. It stands for the shape of the spectrum, which keeps that of kLowest beyond.
  double frequency_ratio(double nepers) const;

 private:
  double variance_;
  double step_nepers_;  ///< length of a piece
  std::vector<Piece> pieces_;
};

/// Two-way losses in tissue and at its interfaces; those that the options switch off are 0.
class TissueLosses {
 public:
  /// Lower bound of an interface's transmission, so that an axis behind a total reflection can be
  /// compared with paths beside it. Echoes at this level, -140 dB, are invisible.
  static constexpr double kLeastTransmission = 1e-7;

  /// `materials` must outlive it.
  TissueLosses(const hw::AcquisitionPlan& plan,
               const SimulationOptions& options,
               const std::vector<phantoms::Material>& materials);

  /// Absorption at the centre frequency per metre of range.
  double nepers_per_m(phantoms::MaterialIndex material) const {
    return nepers_per_m_[static_cast<std::size_t>(material)];
  }
  /// Amplitude behind an interface relative to that before it, 1 - R^2; 0 at a total reflection.
  double transmission(const Interface& crossed) const;

 private:
  const std::vector<phantoms::Material>* materials_;
  bool interfaces_;
  std::vector<double> nepers_per_m_;  ///< of each material
};

}  // namespace wobblebench::sim
