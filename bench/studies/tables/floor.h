// Lower bound of the time of each pass: its texture fetches at the rate that this machine reaches.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bench/studies/tables/variant.h"
#include "hw/probe/polar_volume.h"
#include "render/gl/context.h"
#include "render/gl/texels.h"

namespace wobblebench::bench {

struct PassFloor {
  std::string pass;
  render::FetchCounts fetches;  ///< of one whole frame, upload included
  double floor_ms = 0;          ///< time of these fetches alone

  std::int64_t total() const;
};

struct Floors {
  std::map<render::TextureFetch, double> rates_per_us;       ///< millions a second
  std::map<PipelineVariant, std::vector<PassFloor>> passes;  ///< in the renderer's order
};

/// "sampler2DArray rg16 linear".
std::string to_string(const render::TextureFetch& kind);

/// Counts the fetches of one frame of each variant, and measures the rate of each kind.
/// Throws as render::Renderer does.
Floors measure_floors(const hw::PolarVolume& volume,
                      const std::map<PipelineVariant, render::RenderOptions>& variants,
                      render::GlContext& context);

}  // namespace wobblebench::bench
