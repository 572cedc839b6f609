#include "render/gl/timer.h"

#include <glad/gl.h>

#include <algorithm>

namespace wobblebench::render {

PassTimer::PassTimer() : query_(make_timer_query()) {
  // llvmpipe returns the time since boot for a context's first query that times anything, so the
  // first one is discarded here.
  const Texture texture("timer", TexelFormat::r32f, {1, 1}, TextureFilter::nearest);
  const Framebuffer target({&texture});
  const float zero[4] = {};
  glBeginQuery(GL_TIME_ELAPSED, query_.id());
  glClearNamedFramebufferfv(target.id(), GL_COLOR, 0, zero);
  glEndQuery(GL_TIME_ELAPSED);
  glFinish();
}

void PassTimer::begin() {
  glFinish();
  start_ = std::chrono::steady_clock::now();
  glBeginQuery(GL_TIME_ELAPSED, query_.id());
}

void PassTimer::end(PassTime& total) {
  glEndQuery(GL_TIME_ELAPSED);
  glFinish();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start_;
  GLuint64 nanoseconds = 0;
  glGetQueryObjectui64v(query_.id(), GL_QUERY_RESULT, &nanoseconds);
  total.ms += wall.count();
  total.gpu_ms = std::max(total.gpu_ms, 0.0) + 1e-6 * static_cast<double>(nanoseconds);
}

}  // namespace wobblebench::render
