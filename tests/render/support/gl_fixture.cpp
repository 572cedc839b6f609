#include "tests/render/support/gl_fixture.h"

namespace wobblebench::render::testing {

GlContext& gl_context() {
  static const std::unique_ptr<GlContext> context = make_context();
  context->make_current();
  return *context;
}

}  // namespace wobblebench::render::testing
