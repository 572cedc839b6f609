// The four-pass renderer, as a stream takes it.
#pragma once

#include "bench/pipeline/stream/stream.h"
#include "render/renderer.h"

namespace wobblebench::bench {

class GlStreamRenderer : public StreamRenderer {
 public:
  /// `renderer` must outlive it.
  explicit GlStreamRenderer(render::Renderer& renderer) : renderer_(renderer) {}

  double add_frame(int frame, const hw::PolarFrame& samples) override {
    renderer_.add_frame(frame, samples);
    return renderer_.update().ms;
  }
  render::Picture render() override { return renderer_.render(); }

 private:
  render::Renderer& renderer_;
};

}  // namespace wobblebench::bench
