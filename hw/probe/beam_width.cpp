#include "hw/probe/beam_width.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <stdexcept>
#include <vector>

#include "base/units.h"

namespace wobblebench::hw {
namespace {

constexpr int kPositions = 40;  ///< from the axis to where the beam is over
constexpr double kNearest_m = 10e-3;

/// Sources on an arc about the centre of curvature, in the plane of (across the axis, along it).
struct Aperture {
  double length_m;  ///< along the arc
  double radius_m;
  double focus_m;    ///< on the axis, where all sources arrive in phase
  double element_m;  ///< width of an element, which makes it directive; 0: a point

  /// Near enough to each other for the curvature of the phase far before and behind the focus.
  int sources(double wave_number) const {
    const double spacing_m = 0.75 * 2 * kPi / wave_number;
    return std::clamp(static_cast<int>(std::ceil(length_m / spacing_m)), 16, 256);
  }
};

/// Directivity of an element towards a point: sinc of its width over the wavelength.
double directivity(const Aperture& aperture, double wave_number, double sine) {
  const double phase = 0.5 * wave_number * aperture.element_m * sine;
  return std::abs(phase) < 1e-6 ? 1 : std::sin(phase) / phase;
}

struct Source {
  glm::dvec2 position_m;
  glm::dvec2 normal;
  double focus_distance_m;
};

std::vector<Source> sources_of(const Aperture& aperture, double wave_number) {
  const glm::dvec2 focus_m(0, aperture.focus_m);
  const int count = aperture.sources(wave_number);
  std::vector<Source> sources;
  for (int i = 0; i < count; ++i) {
    const double angle = ((i + 0.5) / count - 0.5) * aperture.length_m / aperture.radius_m;
    const glm::dvec2 normal(std::sin(angle), std::cos(angle));
    const glm::dvec2 source_m = aperture.radius_m * (normal - glm::dvec2(0, 1));
    sources.push_back({source_m, normal, glm::distance(focus_m, source_m)});
  }
  return sources;
}

double pressure(const Aperture& aperture,
                const std::vector<Source>& sources,
                double wave_number,
                glm::dvec2 point_m) {
  std::complex<double> sum;
  for (const Source& source : sources) {
    const double distance_m = glm::distance(point_m, source.position_m);
    const glm::dvec2 towards = (point_m - source.position_m) / distance_m;
    const double sine = towards.x * source.normal.y - towards.y * source.normal.x;
    sum += std::polar(directivity(aperture, wave_number, sine),
                      wave_number * (distance_m - source.focus_distance_m));
  }
  return std::abs(sum) / static_cast<int>(sources.size());
}

/// A distance from the axis beyond which there is next to no beam: diffraction and the spread
/// before and behind the focus.
double reach_m(const Aperture& aperture, double wave_number, double range_m) {
  return 1.5 * (2 * kPi / wave_number * range_m / aperture.length_m +
                aperture.length_m * std::abs(range_m / aperture.focus_m - 1));
}

/// Full width between the outermost points at half of the largest value. `bandwidth`: -6 dB,
/// relative.
double width_m(const Aperture& transmit,
               const Aperture& receive,
               double wave_number,
               double bandwidth,
               double range_m) {
  constexpr double kStandardDeviations[] = {-2, -1, 0, 1, 2};  // of the pulse's Gaussian spectrum
  const double deviation = bandwidth / (2 * std::sqrt(2 * std::log(2.0)));
  const double step_m =
      std::min(reach_m(transmit, wave_number, range_m), reach_m(receive, wave_number, range_m)) /
      kPositions;
  std::array<double, kPositions + 1> profile{};
  for (const double x : kStandardDeviations) {
    const double k = wave_number * std::max(1 + x * deviation, 0.1);
    const auto sent_from = sources_of(transmit, k), received_at = sources_of(receive, k);
    for (std::size_t i = 0; i < profile.size(); ++i) {
      const glm::dvec2 point_m(static_cast<double>(i) * step_m, range_m);
      const double sent = pressure(transmit, sent_from, k, point_m);
      const double received =
          &receive == &transmit ? sent : pressure(receive, received_at, k, point_m);
      profile[i] += std::exp(-0.5 * x * x) * sent * received;
    }
  }
  const double half = 0.5 * *std::ranges::max_element(profile);
  std::size_t last = kPositions;
  while (profile[last] < half) --last;
  if (last == kPositions) return 2 * kPositions * step_m;
  const double share = (profile[last] - half) / (profile[last] - profile[last + 1]);
  return 2 * (static_cast<double>(last) + share) * step_m;
}

}  // namespace

void validate_known(const ProbeOptions& probe) {
  ProbeOptions checked = probe;
  if (!knows_array(probe)) checked.elements = ProbeOptions{}.elements;
  if (!knows_lens(probe)) checked.element_height_m = ProbeOptions{}.element_height_m;
  validate(checked);
}

ProbeOptions with_aperture_of(const ProbeOptions& probe, const ProbeOptions& other) {
  ProbeOptions result = probe;
  if (!knows_array(probe)) {
    result.elements = other.elements;
    result.pitch_m = other.pitch_m;
    result.f_number = other.f_number;
    result.transmit_focus_m = other.transmit_focus_m;
  }
  if (!knows_lens(probe)) {
    result.element_height_m = other.element_height_m;
    result.elevation_focus_m = other.elevation_focus_m;
  }
  if (!knows_array(probe) && !knows_lens(probe) && (knows_array(other) || knows_lens(other))) {
    result.center_frequency_hz = other.center_frequency_hz;
    result.fractional_bandwidth = other.fractional_bandwidth;
  }
  return result;
}

BeamWidth beam_width(const AcquisitionPlan& plan, double range_m) {
  if (!(range_m > 0)) throw std::invalid_argument("beam_width: the range must be above 0");
  const ProbeOptions& probe = plan.probe();
  const double wave_number =
      2 * kPi * probe.center_frequency_hz / plan.acquisition().sound_speed_m_s;
  // No element sees a point on the axis from the far half of the face.
  const double array_m = std::min(probe.elements * probe.pitch_m, 0.9 * kPi * probe.radius_m);
  const auto focused_at = [&](double focus_m) {
    return Aperture{
        std::min(focus_m / probe.f_number, array_m), probe.radius_m, focus_m, probe.pitch_m};
  };
  constexpr double kFlat_m = 1e3;
  const Aperture lens{probe.element_height_m, kFlat_m, probe.elevation_focus_m, 0};
  const auto width = [&](const Aperture& transmit, const Aperture& receive) {
    return width_m(transmit, receive, wave_number, probe.fractional_bandwidth, range_m);
  };
  return {knows_array(probe) ? width(focused_at(probe.transmit_focus_m), focused_at(range_m)) : 0,
          knows_lens(probe) ? width(lens, lens) : 0};
}

BeamWidths::BeamWidths(const AcquisitionPlan& plan)
    : first_m_(std::min(kNearest_m, 0.5 * plan.acquisition().depth_m)),
      last_m_(plan.acquisition().depth_m) {
  for (int row = 0; row < kRows; ++row) {
    rows_.push_back(beam_width(plan, first_m_ + row * (last_m_ - first_m_) / (kRows - 1)));
  }
}

BeamWidth BeamWidths::at(double range_m) const {
  const double row =
      std::clamp((range_m - first_m_) / (last_m_ - first_m_), 0.0, 1.0) * (kRows - 1);
  const auto first = std::min(static_cast<std::size_t>(row), rows_.size() - 2);
  const double share = row - static_cast<double>(first);
  const BeamWidth &a = rows_[first], &b = rows_[first + 1];
  return {a.lateral_m + share * (b.lateral_m - a.lateral_m),
          a.elevation_m + share * (b.elevation_m - a.elevation_m)};
}

}  // namespace wobblebench::hw
