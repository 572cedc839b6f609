// Which keys give the aperture of a probe, whose beam has a width: those of a scene's probe.* and
// of a geometry file.
#pragma once

#include <functional>
#include <string>

#include "hw/probe/probe.h"

namespace wobblebench::bench {

/// The probe, not knowing the array or the lens (hw/probe/beam_width.h) whose keys are not given.
/// `has`: whether a key, "elements" say, is given; a preset gives all. Each is given by all of its
/// keys. Calls `refuse`, which throws, with "KEY: why" for one that is missing.
hw::ProbeOptions with_given_aperture(const hw::NamedProbeOptions& probe,
                                     const std::function<bool(const std::string& key)>& has,
                                     const std::function<void(const std::string& why)>& refuse);

/// Of a preset that is taken for a probe whose face has this radius: why not; empty: they agree.
/// A radius is read off a scan to some percent.
std::string preset_refusal(hw::ProbePreset preset, double radius_m);

}  // namespace wobblebench::bench
