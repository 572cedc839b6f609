#include "sim/optics/stick_aperture.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr double kTukeyTaper = 0.5;  // share of the aperture over which it falls

/// Weight of the window at a place on the aperture, -1 to 1.
double window(Apodisation apodisation, double place) {
  const double away = std::min(std::abs(place), 1.0);
  switch (apodisation) {
    case Apodisation::rectangular:
      return 1;
    case Apodisation::hann:
      return 0.5 * (1 + std::cos(kPi * away));
    case Apodisation::tukey: {
      const double into_taper = (away - (1 - kTukeyTaper)) / kTukeyTaper;
      return into_taper <= 0 ? 1 : 0.5 * (1 + std::cos(kPi * into_taper));
    }
  }
  return 1;
}

}  // namespace

StickAperture::StickAperture(const hw::AcquisitionPlan& plan,
                             Apodisation apodisation,
                             double theta_rad)
    : plan_(plan), apodisation_(apodisation) {
  const auto& probe = plan.probe();
  for (int e = 0; e < probe.elements; ++e) {
    const double angle =
        (e - 0.5 * (probe.elements - 1)) * probe.pitch_m / probe.radius_m - theta_rad;
    elements_.push_back(
        {probe.radius_m * (std::cos(angle) - 1), probe.radius_m * std::sin(angle), angle});
  }
}

double StickAperture::weight(const Element& element, double aperture_m) const {
  // An element on the far side of the face does not see the focus.
  if (std::abs(element.angle_rad) >= 0.5 * kPi) return 0;
  const double half_m = 0.5 * aperture_m;
  const double place_m = element.angle_rad * plan_.probe().radius_m;  // along the face
  const double share =
      std::clamp((half_m - std::abs(place_m)) / plan_.probe().pitch_m + 0.5, 0.0, 1.0);
  return share == 0 ? 0 : share * window(apodisation_, place_m / half_m);
}

bool StickAperture::whole(double range_m) const {
  const double half_m =
      0.5 * std::max(transmit_aperture_m(plan_, range_m), receive_aperture_m(plan_, range_m));
  const double half_pitch_m = 0.5 * plan_.probe().pitch_m;
  const double first_m = elements_.front().angle_rad * plan_.probe().radius_m - half_pitch_m;
  const double last_m = elements_.back().angle_rad * plan_.probe().radius_m + half_pitch_m;
  return first_m <= -half_m && last_m >= half_m;
}

double StickAperture::transmit_weight(const Element& element, double range_m) const {
  return weight(element, transmit_aperture_m(plan_, range_m));
}

double StickAperture::receive_weight(const Element& element, double range_m) const {
  return weight(element, receive_aperture_m(plan_, range_m));
}

double StickAperture::excess_m(const Element& element, double focus_m) {
  return std::hypot(focus_m - element.axial_m, element.lateral_m) - focus_m;
}

ElevationSources::ElevationSources(const hw::AcquisitionPlan& plan) {
  const auto& probe = plan.probe();
  const double half_wave_m = 0.5 * wavelength_m(plan);
  const int count = std::max(1, static_cast<int>(std::ceil(probe.element_height_m / half_wave_m)));
  for (int i = 0; i < count; ++i) {
    height_m.push_back(((i + 0.5) / count - 0.5) * probe.element_height_m);
    lens_m.push_back(probe.elevation_focus_m -
                     std::hypot(probe.elevation_focus_m, height_m.back()));
  }
}

}  // namespace wobblebench::sim
