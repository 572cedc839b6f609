// Progress on stderr: one line for each finished step with its wall time; on a terminal the current
// step, too.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/report_parts.h"

namespace wobblebench::bench {

class Progress {
 public:
  /// Runs one step, prints its wall time, and returns its result. A step that throws prints
  /// nothing: the error message is the only line.
  template <class Step>
  auto step(const std::string& name, const Step& body) {
    if (on_terminal()) std::fprintf(stderr, "%s …\r", name.c_str());
    const Finish finish{*this, name, Clock::now()};
    return body();
  }

  /// Of the steps so far, in their order.
  const StepTimes& steps() const { return steps_; }
  /// Likewise, and "total": since this was made.
  StepTimes times() const {
    StepTimes times = steps_;
    times.emplace_back("total", milliseconds_since(start_));
    return times;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }
  static bool on_terminal() { return ::isatty(STDERR_FILENO) == 1; }
  struct Finish {
    Progress& progress;
    std::string name;
    Clock::time_point start;
    int exceptions = std::uncaught_exceptions();
    ~Finish() {
      if (std::uncaught_exceptions() > exceptions) return;
      const double ms = milliseconds_since(start);
      std::fprintf(stderr, "%-12s %8.0f ms\n", name.c_str(), ms);
      progress.steps_.emplace_back(name, ms);
    }
  };

  Clock::time_point start_ = Clock::now();
  StepTimes steps_;
};

}  // namespace wobblebench::bench
