#include "bench/studies/tables/floor.h"

#include <array>

#include "render/gl/fetch_count.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

std::vector<PassFloor> count_fetches(const hw::PolarVolume& volume,
                                     const render::RenderOptions& options,
                                     render::GlContext& context) {
  const render::FetchCounter counter;
  std::vector<PassFloor> passes;
  for (const auto& pass : render::render_volume(context, volume, options).passes) {
    passes.push_back({pass.name, pass.fetches});
  }
  return passes;
}

}  // namespace

std::int64_t PassFloor::total() const {
  std::int64_t all = 0;
  for (const auto& [kind, count] : fetches) all += count;
  return all;
}

std::string to_string(const render::TextureFetch& kind) {
  constexpr std::array kSamplers = {"sampler2D", "sampler3D", "sampler2DArray"};
  constexpr std::array kFormats = {
      "r8", "r16", "r32f", "rg8", "rg16", "rg32f", "rgba8", "rgba16", "rgb32f", "rgba32f"};
  constexpr std::array kFilters = {"nearest", "linear"};
  return std::string(kSamplers.at(static_cast<std::size_t>(kind.sampler))) + " " +
         kFormats.at(static_cast<std::size_t>(kind.format)) + " " +
         kFilters.at(static_cast<std::size_t>(kind.filter));
}

Floors measure_floors(const hw::PolarVolume& volume,
                      const std::map<PipelineVariant, render::RenderOptions>& variants,
                      render::GlContext& context) {
  context.make_current();
  Floors floors;
  for (const auto& [variant, options] : variants) {
    auto& passes = floors.passes[variant] = count_fetches(volume, options, context);
    for (PassFloor& pass : passes) {
      for (const auto& [kind, count] : pass.fetches) {
        if (!floors.rates_per_us.contains(kind)) {
          floors.rates_per_us[kind] = render::fetch_rate_per_us(kind);
        }
        pass.floor_ms += 1e-3 * static_cast<double>(count) / floors.rates_per_us[kind];
      }
    }
  }
  return floors;
}

}  // namespace wobblebench::bench
