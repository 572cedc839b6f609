// The end of GL objects whose context cannot be made current.
#pragma once

namespace wobblebench::render {

/// While one exists on this thread, objects (render/gl/objects.h) forget their names instead of
/// deleting them, which would delete another context's. The names go with their context.
class ForgetNames {
 public:
  ForgetNames();
  ~ForgetNames();
  ForgetNames(const ForgetNames&) = delete;
  ForgetNames& operator=(const ForgetNames&) = delete;
};

}  // namespace wobblebench::render
