#include "sim/optics/probe_optics.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "base/units.h"
#include "sim/optics/beam_profile.h"

namespace wobblebench::sim {

namespace {

constexpr double kTukeyTaper = 0.5;  ///< fraction of the aperture over which the window falls

/// Weight of the window at a position on the aperture, -1 to 1.
double window(Apodisation apodisation, double position) {
  const double away = std::min(std::abs(position), 1.0);
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

double wavelength(const hw::AcquisitionPlan& plan) {
  return plan.acquisition().sound_speed_m_s / plan.probe().center_frequency_hz;
}

}  // namespace

ElevationSources::ElevationSources(const hw::AcquisitionPlan& plan) {
  const auto& probe = plan.probe();
  const double half_wave_m = 0.5 * wavelength(plan);
  const int count = std::max(1, static_cast<int>(std::ceil(probe.element_height_m / half_wave_m)));
  for (int i = 0; i < count; ++i) {
    height_m.push_back(((i + 0.5) / count - 0.5) * probe.element_height_m);
    lens_m.push_back(probe.elevation_focus_m -
                     std::hypot(probe.elevation_focus_m, height_m.back()));
  }
}

struct ProbeOptics::LazyProfile {
  std::once_flag once;
  std::optional<BeamProfile> profile;
};

ProbeOptics::ProbeOptics(const hw::AcquisitionPlan& plan, const SimulationOptions& options)
    : constants_(std::make_shared<const Constants>(
          Constants{plan,
                    options.apodisation,
                    options.threads,
                    PulseBand(plan),
                    ElevationSources(plan),
                    wavelength(plan),
                    sim::axial_fwhm_m(plan),
                    plan.acquisition().samples_per_stick * iq_oversampling(plan),
                    plan.sample_spacing_m() / iq_oversampling(plan)})),
      profile_(std::make_shared<LazyProfile>()) {}

const BeamProfile& ProbeOptics::profile() const {
  std::call_once(profile_->once, [this] { profile_->profile.emplace(*this); });
  return *profile_->profile;
}

double ProbeOptics::transmit_focus_m(double range_m) const {
  const auto& acquisition = plan().acquisition();
  if (acquisition.focal_zones == 1) return probe().transmit_focus_m;
  const double zone_m = acquisition.depth_m / acquisition.focal_zones;
  const double zone = std::floor(std::clamp(range_m, 0.0, acquisition.depth_m) / zone_m);
  return (std::min(zone, acquisition.focal_zones - 1.0) + 0.5) * zone_m;
}

double ProbeOptics::receive_aperture_m(double range_m) const {
  return sim::receive_aperture_m(probe(), range_m);
}

double receive_aperture_m(const hw::ProbeOptions& probe, double range_m) {
  return std::min(range_m / probe.f_number, probe.elements * probe.pitch_m);
}

StickAperture::StickAperture(const ProbeOptics& optics, double theta_rad) : optics_(optics) {
  const auto& probe = optics.probe();
  for (int e = 0; e < probe.elements; ++e) {
    const double angle =
        (e - 0.5 * (probe.elements - 1)) * probe.pitch_m / probe.radius_m - theta_rad;
    elements_.push_back(
        {probe.radius_m * (std::cos(angle) - 1), probe.radius_m * std::sin(angle), angle});
  }
}

/// `aperture_m`: length that the F-number asks for, about the stick. The array may be shorter: then
/// its elements are used as far as they lie within, and the window's middle is that of the length
/// `half_m` to either side that lies closest to the array.
double StickAperture::weight(const Element& element, double aperture_m) const {
  // The focus is not visible from an element on the far side of the face.
  if (std::abs(element.angle_rad) >= 0.5 * kPi) return 0;
  const auto& probe = optics_.probe();
  const double half_m = 0.5 * std::min(aperture_m, probe.elements * probe.pitch_m);
  const double most_m = 0.5 * aperture_m - half_m;
  const double array_m =
      0.5 * (elements_.front().angle_rad + elements_.back().angle_rad) * probe.radius_m;
  const double middle_m = std::clamp(array_m, -most_m, most_m);
  const double position_m = element.angle_rad * probe.radius_m - middle_m;  // along the face
  const double share = std::clamp((half_m - std::abs(position_m)) / probe.pitch_m + 0.5, 0.0, 1.0);
  if (share == 0) return 0;
  // Near the face the aperture is narrower than two elements, whose centres lie beyond its ends:
  // the window is that of two, so that the middle stick of an even array is not silent.
  return share * window(optics_.apodisation(), position_m / std::max(half_m, probe.pitch_m));
}

bool StickAperture::whole(double range_m) const {
  const auto& probe = optics_.probe();
  const double half_m =
      0.5 * std::max(optics_.transmit_aperture_m(range_m), optics_.receive_aperture_m(range_m));
  const double half_pitch_m = 0.5 * probe.pitch_m;
  const double first_m = elements_.front().angle_rad * probe.radius_m - half_pitch_m;
  const double last_m = elements_.back().angle_rad * probe.radius_m + half_pitch_m;
  return first_m <= -half_m && last_m >= half_m;
}

double StickAperture::transmit_weight(const Element& element, double range_m) const {
  return weight(element, optics_.transmit_focus_m(range_m) / optics_.probe().f_number);
}

double StickAperture::receive_weight(const Element& element, double range_m) const {
  return weight(element, range_m / optics_.probe().f_number);
}

double StickAperture::excess_m(const Element& element, double focus_m) {
  return std::hypot(focus_m - element.axial_m, element.lateral_m) - focus_m;
}

}  // namespace wobblebench::sim
