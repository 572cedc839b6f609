// Settings of the renderer by name.
#pragma once

#include <string_view>

#include "render/options.h"

namespace wobblebench::render {

/// `baseline`: the defaults of RenderOptions, which are the paper's but for three
/// (docs/decisions/0006-defaults-of-the-probe.md). `accurate`: sticks aligned by
/// their surface, an iso-surface at a level that each stick says, corrected for the beam's width
/// (docs/decisions/0031-the-surface.md).
enum class RenderPreset { accurate, baseline };

constexpr std::string_view to_string(RenderPreset preset) {
  return preset == RenderPreset::baseline ? "baseline" : "accurate";
}

/// The settings that a preset stands for.
RenderOptions render_preset(RenderPreset preset);

}  // namespace wobblebench::render
