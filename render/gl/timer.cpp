#include "render/gl/timer.h"

#include <glad/gl.h>

#include <algorithm>
#include <utility>

#include "base/duration.h"

namespace wobblebench::render {

/// llvmpipe returns the time since boot for a context's first query that times anything.
void PassTimer::discard_first() {
  if (!std::exchange(is_first_, false)) return;
  const Texture texture("timer", TexelFormat::r32f, {1, 1}, TextureFilter::nearest);
  const Framebuffer target({&texture});
  const float zero[4] = {};
  glBeginQuery(GL_TIME_ELAPSED, query_.id());
  glClearNamedFramebufferfv(target.id(), GL_COLOR, 0, zero);
  glEndQuery(GL_TIME_ELAPSED);
}

void PassTimer::begin() {
  GLint of_host = 0;
  glGetQueryiv(GL_TIME_ELAPSED, GL_CURRENT_QUERY, &of_host);
  is_querying_ = of_host == 0;
  if (is_querying_) discard_first();
  glFinish();
  start_ = std::chrono::steady_clock::now();
  if (is_querying_) glBeginQuery(GL_TIME_ELAPSED, query_.id());
}

void PassTimer::end(PassTime& total) {
  if (is_querying_) glEndQuery(GL_TIME_ELAPSED);
  glFinish();
  total.ms += to_milliseconds(std::chrono::steady_clock::now() - start_);
  if (!is_querying_) return;
  GLuint64 nanoseconds = 0;
  glGetQueryObjectui64v(query_.id(), GL_QUERY_RESULT, &nanoseconds);
  total.gpu_ms = std::max(total.gpu_ms, 0.0) + 1e-6 * static_cast<double>(nanoseconds);
}

}  // namespace wobblebench::render
