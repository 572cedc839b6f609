// Probe options by name.
#pragma once

#include <string_view>

#include "hw/probe/probe.h"

namespace wobblebench::hw {

enum class ProbePreset {
  standard,       ///< "default": the defaults of ProbeOptions
  c5_2v,          ///< "c5-2v"
  curvilinear_60  ///< "curvilinear-60"
};

/// A probe's options and their sources.
struct ProbePresetData {
  /// Source of the values; after "assumed:" those that the source does not give.
  std::string_view source;
  ProbeOptions probe;
  double sector_rad;
};

const ProbePresetData& probe_preset(ProbePreset preset);

/// Probe options that start from a preset: where a visitor sets `preset`, that preset's values are
/// the defaults of the keys that follow.
///
/// @code
/// const hw::ProbePresetData& data = hw::probe_preset(hw::ProbePreset::c5_2v);
/// hw::NamedProbeOptions probe;
/// static_cast<hw::ProbeOptions&>(probe) = data.probe;
/// probe.preset = hw::ProbePreset::c5_2v;
/// probe.f_number = 2.5;
/// hw::validate(probe);
/// @endcode
struct NamedProbeOptions : ProbeOptions {
  ProbePreset preset = ProbePreset::standard;
};

template <OptionsOf<NamedProbeOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  [[maybe_unused]] const ProbePreset before = o.preset;
  v.choice("preset",
           o.preset,
           {{"default", ProbePreset::standard},
            {"c5-2v", ProbePreset::c5_2v},
            {"curvilinear-60", ProbePreset::curvilinear_60}});
  if constexpr (!std::is_const_v<O>) {
    if (o.preset != before) static_cast<ProbeOptions&>(o) = probe_preset(o.preset).probe;
  }
  v.constant("preset_source", probe_preset(o.preset).source);
  using Base = std::conditional_t<std::is_const_v<O>, const ProbeOptions, ProbeOptions>;
  describe(static_cast<Base&>(o), v);
}

}  // namespace wobblebench::hw
