#include "bench/pipeline/background_renderer.h"

namespace wobblebench::bench {

namespace {

struct ReleaseAtEnd {
  render::GlContext& context;
  ~ReleaseAtEnd() { context.release(); }
};

}  // namespace

BackgroundRenderer::BackgroundRenderer(render::GlContext& context,
                                       const hw::AcquisitionPlan& plan,
                                       const render::RenderOptions& options)
    : context_(context) {
  context.release();
  made_ = std::async(std::launch::async, [&context, plan, options] {
    const ReleaseAtEnd hand_over{context};
    auto renderer = std::make_unique<render::Renderer>(context, plan, options);
    renderer->warm_up();
    return renderer;
  });
}

std::unique_ptr<render::Renderer> BackgroundRenderer::get() {
  auto renderer = made_.get();
  context_.make_current();
  return renderer;
}

}  // namespace wobblebench::bench
