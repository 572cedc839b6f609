// The clock of a fault simulation.
#pragma once

#include "hw/probe/clock.h"

namespace wobblebench::bench {

class VirtualTime : public hw::HostTimeSource {
 public:
  hw::HostTime now() const override { return now_; }
  void advance(hw::HostClock::duration duration) { now_ += duration; }

 private:
  hw::HostTime now_{};
};

}  // namespace wobblebench::bench
