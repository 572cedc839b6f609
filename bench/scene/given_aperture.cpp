#include "bench/scene/given_aperture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/number_text.h"
#include "base/units.h"

namespace wobblebench::bench {

namespace {

using Keys = std::vector<std::string>;

constexpr double kSameRadius = 0.05;  ///< relative

/// Whether one of the keys is given, and then all.
bool gives_all(const Keys& keys,
               const std::function<bool(const std::string& key)>& has,
               const std::function<void(const std::string& why)>& refuse) {
  const auto given = std::ranges::find_if(keys, has);
  if (given == keys.end()) return false;
  Keys needed = keys;
  needed.emplace_back("center_frequency_mhz");
  for (const std::string& key : needed) {
    if (!has(key)) refuse(key + ": is missing; the beam's width follows from it and " + *given);
  }
  return true;
}

}  // namespace

hw::ProbeOptions with_given_aperture(const hw::NamedProbeOptions& probe,
                                     const std::function<bool(const std::string& key)>& has,
                                     const std::function<void(const std::string& why)>& refuse) {
  hw::ProbeOptions result = probe;
  if (has("preset")) return result;
  if (!gives_all({"elements", "pitch_mm", "f_number", "transmit_focus_mm"}, has, refuse)) {
    result.elements = 0;
  }
  if (!gives_all({"element_height_mm", "elevation_focus_mm"}, has, refuse)) {
    result.element_height_m = 0;
  }
  return result;
}

std::string preset_refusal(hw::ProbePreset preset, double radius_m) {
  const double of_preset_m = hw::probe_preset(preset).probe.radius_m;
  if (std::abs(radius_m - of_preset_m) <= kSameRadius * of_preset_m) return "";
  return "its face has a radius of " + significant(of_preset_m / kMillimetre, 4) +
         " mm, and that of this scan " + significant(radius_m / kMillimetre, 4) + " mm";
}

}  // namespace wobblebench::bench
