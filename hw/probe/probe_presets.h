// Probes by name.
#pragma once

#include <string_view>

#include "hw/probe/probe.h"

namespace wobblebench::hw {

enum class ProbePreset {
  standard,       ///< "default": what ProbeOptions holds
  c5_2v,          ///< "c5-2v"
  curvilinear_60  ///< "curvilinear-60"
};

/// What is known of a probe, and what had to be assumed.
struct ProbePresetData {
  /// Where the figures come from; behind "assumed:" those that the source does not give.
  std::string_view source;
  ProbeOptions probe;
  double sector_rad;
};

const ProbePresetData& probe_preset(ProbePreset preset);

/// A probe that begins as a preset: a visitor of its description that reads another preset gets
/// that one's values as defaults for the keys that follow.
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
