#include "bench/command/software_renderer.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace wobblebench::bench {

bool is_software(const std::string& renderer) {
  constexpr std::array<std::string_view, 4> kRasterisers = {
      "llvmpipe", "softpipe", "swrast", "Software Rasterizer"};
  return std::ranges::any_of(kRasterisers, [&](std::string_view name) {
    return renderer.find(name) != std::string::npos;
  });
}

void warn_of_software(const render::GlContext& context,
                      const std::string& wanted,
                      Progress& progress) {
  const std::string renderer = context.renderer_string();
  if (wanted != "egl-device" || !is_software(renderer)) return;
  progress.warn("--gl = egl-device: no GPU gives a context; " + renderer + " renders on the CPU");
}

}  // namespace wobblebench::bench
