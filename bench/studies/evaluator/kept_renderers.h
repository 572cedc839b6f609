// Renderers that stay alive while settings change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <optional>

#include "bench/scene/resolved_scene.h"
#include "hw/probe/polar_volume.h"
#include "render/renderer.h"

namespace wobblebench::bench {

class KeptRenderers {
 public:
  /// As many as fit into a quarter of the memory, at least one and at most four.
  KeptRenderers(const ResolvedScene& scene, render::GlContext& context);

  /// The sticks that new pictures show.
  void scan(hw::PolarVolume sticks);
  /// Only after scan().
  const hw::PolarVolume& sticks() const { return sticks_.value(); }

  /// One with these settings and the sticks. `as_new`: with the sticks as a new volume, and
  /// compiled, so that the next picture takes no longer than others. Valid until the next call.
  /// Throws as render::Renderer.
  render::Renderer& of(const render::RenderOptions& options, bool as_new);

 private:
  struct Kept {
    std::unique_ptr<render::Renderer> renderer;
    render::RenderOptions options;
    std::uint64_t scan = 0;    ///< whose sticks it has; 0: none
    bool is_compiled = false;  ///< for these options
  };

  Kept& with(const render::RenderOptions& options);

  hw::AcquisitionPlan plan_;
  render::GlContext& context_;
  std::size_t most_;
  std::optional<hw::PolarVolume> sticks_;
  std::uint64_t scans_ = 0;
  std::list<Kept> renderers_;  ///< in the order of their last use
};

}  // namespace wobblebench::bench
