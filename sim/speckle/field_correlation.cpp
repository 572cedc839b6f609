#include "sim/speckle/field_correlation.h"

#include <cmath>

#include "base/units.h"
#include "sim/math/complex.h"
#include "sim/math/fast_math.h"
#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr int kColumns = 48;  ///< a side, over the beam

/// Half of the beam: three lobes, and the shadow of the transmitting aperture.
double reach_m(double lobe_m, double transmit_m, double range_m, double focus_m) {
  return 3 * lobe_m + 0.6 * transmit_m * std::abs(1 - range_m / focus_m);
}

double elevation_reach_m(const hw::AcquisitionPlan& plan, double range_m) {
  const double height_m = plan.probe().element_height_m;
  return reach_m(
      wavelength_m(plan) * range_m / height_m, height_m, range_m, plan.probe().elevation_focus_m);
}

std::complex<double> unit_phasor(double phase_rad) {
  const CosSin at = cos_sin_of_cycles(static_cast<float>(phase_rad / (2 * kPi)));
  return {static_cast<double>(at.cosine), static_cast<double>(at.sine)};
}

}  // namespace

ElevationPlane::ElevationPlane(const hw::AcquisitionPlan& plan,
                               const PulseBand& band,
                               Apodisation apodisation,
                               double range_m)
    : response(PlaneResponse::elevation(
          ElevationSources(plan),
          band,
          InPlaneExcess(StickAperture(plan, apodisation, 0), plan, band, range_m))),
      row(sample_row(response, range_m, elevation_reach_m(plan, range_m), true, kColumns)) {}

SampledRow lateral_row(const hw::AcquisitionPlan& plan,
                       const PulseBand& band,
                       Apodisation apodisation,
                       double range_m,
                       double theta_rad) {
  const StickAperture aperture(plan, apodisation, theta_rad);
  return sample_row(PlaneResponse::lateral(aperture, plan, band, range_m),
                    range_m,
                    lateral_reach_m(plan, range_m),
                    true,
                    kColumns);
}

double lateral_reach_m(const hw::AcquisitionPlan& plan, double range_m) {
  return reach_m(wavelength_m(plan) * range_m / receive_aperture_m(plan, range_m),
                 transmit_aperture_m(plan, range_m),
                 range_m,
                 transmit_focus_m(plan, range_m));
}

std::array<double, PulseBand::kNodes> node_powers(const SampledRow& row) {
  std::array<double, PulseBand::kNodes> powers = {};
  for (const auto& value : row.values) {
    for (std::size_t node = 0; node < powers.size(); ++node) powers[node] += std::norm(value[node]);
  }
  return powers;
}

FieldCorrelation::FieldCorrelation(const ElevationPlane& plane,
                                   const SampledRow& lateral,
                                   const Turn& turn,
                                   const PulseBand& band)
    : plane_(plane), turn_(turn), weights_(node_powers(lateral)) {
  for (std::size_t node = 0; node < weights_.size(); ++node) {
    weights_[node] *= band.weight(static_cast<int>(node));
    wavenumber_per_m_[node] = band.wavenumber_per_m(static_cast<int>(node));
  }
  power_ = power(turned(0));
}

FieldCorrelation::Heard FieldCorrelation::turned(double turn_rad) const {
  const SampledRow& row = plane_.row;
  Heard heard{turn_.place(0, turn_rad).axial_m, {}, {}};
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    heard.places.push_back(turn_.place(row.offset_m(i), turn_rad));
  }
  heard.values = turn_rad == 0 ? row.values : plane_.response.at(heard.places);
  return heard;
}

double FieldCorrelation::power(const Heard& heard) const {
  double sum = 0;
  for (const auto& value : heard.values) {
    for (std::size_t n = 0; n < weights_.size(); ++n) sum += weights_[n] * std::norm(value[n]);
  }
  return sum;
}

std::complex<double> FieldCorrelation::product(const Heard& here, const Heard& there) const {
  // What all scatterers move along the stick is a phase of the whole field.
  const double common_m = there.middle_m - here.middle_m;
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < there.values.size(); ++i) {
    const double nearer_m = there.places[i].axial_m - here.places[i].axial_m - common_m;
    for (std::size_t n = 0; n < weights_.size(); ++n) {
      const std::complex<double> phasor = unit_phasor(2 * wavenumber_per_m_[n] * nearer_m);
      sum += times(weights_[n] * times(here.values[i][n], std::conj(there.values[i][n])), phasor);
    }
  }
  return sum;
}

std::complex<double> FieldCorrelation::at(double turn_rad) const {
  return product(turned(0), turned(turn_rad)) / power_;
}

}  // namespace wobblebench::sim
