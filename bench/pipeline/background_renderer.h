// A renderer that is made while something else is done.
#pragma once

#include <future>
#include <memory>

#include "hw/probe/acquisition_plan.h"
#include "render/renderer.h"

namespace wobblebench::bench {

/// Makes a renderer on a thread of its own, where the driver compiles its programs. The context
/// belongs to that thread until get(); it must outlive this.
class BackgroundRenderer {
 public:
  /// Starts. The context must be the calling thread's, or no one's.
  BackgroundRenderer(render::GlContext& context,
                     const hw::AcquisitionPlan& plan,
                     const render::RenderOptions& options);

  /// Waits, and makes the context current on the calling thread. Throws what Renderer's
  /// constructor and warm_up() throw.
  [[nodiscard]] std::unique_ptr<render::Renderer> get();

 private:
  render::GlContext& context_;
  std::future<std::unique_ptr<render::Renderer>> made_;
};

}  // namespace wobblebench::bench
