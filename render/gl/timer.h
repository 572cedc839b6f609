// Time of a pass: wall time between glFinish calls, and the driver's timer query. llvmpipe defers
// work, so the two differ and both are reported. While the host runs a timer query of its own, of
// which a context has one at a time, there is only wall time.
#pragma once

#include <chrono>

#include "render/gl/objects.h"
#include "render/picture.h"

namespace wobblebench::render {

class PassTimer {
 public:
  PassTimer() : query_(make_timer_query()) {}
  void begin();
  /// Waits for the work since begin() and adds its time to `total`.
  void end(PassTime& total);

 private:
  void discard_first();

  Query query_;
  bool is_first_ = true;
  bool is_querying_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace wobblebench::render
