#include "hw/probe/probe_presets.h"

#include <array>
#include <cstddef>

namespace wobblebench::hw {
namespace {

/// Angle between the centres of the first and the last element at the centre of curvature.
double sector_of_elements_rad(const ProbeOptions& probe) {
  return (probe.elements - 1) * probe.pitch_m / probe.radius_m;
}

ProbePresetData standard() {
  return {"sector: the paper (docs/references.md [1]); assumed: all others (docs/decisions/0006)",
          {},
          77 * kDegree};
}

ProbePresetData c5_2v() {
  ProbeOptions probe;
  probe.radius_m = 49.57e-3;
  probe.center_frequency_hz = 3.57e6;
  probe.fractional_bandwidth = 0.79;
  probe.elements = 128;
  probe.pitch_m = 0.508e-3;
  probe.element_height_m = 13.5e-3;
  probe.elevation_focus_m = 60e-3;
  return {
      "Verasonics C5-2v in getparam of the MUST toolbox (docs/references.md [14]); sector: what "
      "its elements span; "
      "assumed: that it wobbles, wobble radius, F-number, transmit focus (the defaults)",
      probe,
      sector_of_elements_rad(probe)};
}

ProbePresetData curvilinear_60() {
  ProbeOptions probe;
  probe.radius_m = 60e-3;
  probe.center_frequency_hz = 3.0e6;
  probe.fractional_bandwidth = 1.0;
  probe.elements = 128;
  probe.pitch_m = 0.477e-3;
  probe.element_height_m = 14e-3;
  probe.elevation_focus_m = 50e-3;
  return {
      "curvilinear probe of the RSNA QIBA shear-wave digital phantoms (docs/references.md [15]); "
      "sector: what its "
      "elements span; assumed: number of elements, that it wobbles, wobble radius, F-number, "
      "transmit focus (the defaults)",
      probe,
      sector_of_elements_rad(probe)};
}

}  // namespace

const ProbePresetData& probe_preset(ProbePreset preset) {
  static const std::array<ProbePresetData, 3> presets = {standard(), c5_2v(), curvilinear_60()};
  return presets.at(static_cast<std::size_t>(preset));
}

}  // namespace wobblebench::hw
