// Time of a pass: wall time between glFinish calls, and the driver's timer query. llvmpipe defers
// work, so the two differ and both are reported.
#pragma once

#include <chrono>

#include "render/gl/objects.h"
#include "render/picture.h"

namespace wobblebench::render {

class PassTimer {
 public:
  PassTimer();
  void begin();
  /// Waits for the work since begin() and adds its time to `total`.
  void end(PassTime& total);

 private:
  Query query_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace wobblebench::render
