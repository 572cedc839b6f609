#include "sim/beam/table/lower_frequency.h"

#include <cmath>

#include "base/units.h"
#include "sim/beam/point_spread.h"

namespace wobblebench::sim {

namespace {

/// The range at which the sent frequency is as much out of focus.
double similar_range_m(double range_m, double focus_m, double ratio) {
  return 1 / (1 / focus_m + ratio * (1 / range_m - 1 / focus_m));
}

double squared(double x) {
  return x * x;
}

}  // namespace

LowerFrequency::LowerFrequency(const hw::AcquisitionPlan& plan, const BeamTable& table)
    : plan_(plan), band_(plan), table_(table) {}

/// The transmit beam's offsets shrink by one factor, those of the receive beam, which is in focus,
/// by another: the narrower of the two beams counts most.
double LowerFrequency::lateral_scale(double range_m, double nearer_m, double ratio) const {
  const double wavelength_m = 2 * kPi / band_.center_per_m();
  const double sent_m = transmit_aperture_m(plan_, range_m);
  const double received_m = receive_aperture_m(plan_, nearer_m);
  const double shadow_m = sent_m * (1 - nearer_m / transmit_focus_m(plan_, range_m));
  const double transmit_share = 1 / (squared(wavelength_m * nearer_m / sent_m) + squared(shadow_m));
  const double receive_share = squared(received_m / (wavelength_m * nearer_m));
  const double transmit_scale = ratio * nearer_m / range_m;
  const double receive_scale = transmit_scale * receive_aperture_m(plan_, range_m) / received_m;
  return std::sqrt(
      (transmit_share * squared(transmit_scale) + receive_share * squared(receive_scale)) /
      (transmit_share + receive_share));
}

double LowerFrequency::area_m2(const LowerBeam& beam) const {
  const auto& lateral = table_.normalisation(beam.lateral_row).lateral_power_m;
  const auto& elevation = table_.normalisation(beam.elevation_row).elevation_power_m;
  double area = 0;
  for (int node = 0; node < band_.nodes(); ++node) {
    const auto i = static_cast<std::size_t>(node);
    area += band_.weight(node) * lateral[i] * elevation[i];
  }
  return area / (beam.lateral_scale * beam.elevation_scale);
}

LowerBeam LowerFrequency::at(int row, double ratio) const {
  const double here_m = range_m(row);
  LowerBeam beam;
  beam.lateral_row = table_.row(similar_range_m(here_m, transmit_focus_m(plan_, here_m), ratio));
  beam.elevation_row = table_.row(similar_range_m(here_m, plan_.probe().elevation_focus_m, ratio));
  const double nearer_m = range_m(beam.lateral_row);
  beam.lateral_scale = lateral_scale(here_m, nearer_m, ratio);
  beam.elevation_scale = ratio * range_m(beam.elevation_row) / here_m;
  // Sums over the sources fall with the distance on both ways, and grow with the receive aperture.
  const double sums = squared(nearer_m / here_m) * receive_aperture_m(plan_, here_m) /
                      receive_aperture_m(plan_, nearer_m);
  const auto& own = table_.normalisation(row);
  beam.point_gain = sums * own.lateral_scale * own.elevation_scale /
                    (table_.normalisation(beam.lateral_row).lateral_scale *
                     table_.normalisation(beam.elevation_row).elevation_scale);
  beam.tissue_gain = std::sqrt(table_.area_m2(row) / area_m2(beam)) / ratio;
  return beam;
}

}  // namespace wobblebench::sim
