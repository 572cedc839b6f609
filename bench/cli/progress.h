// Progress on stderr, one line for each finished step with its wall time; on a terminal the step
// under way is shown too. The same times go into the report.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

namespace wobblebench::bench {

class Progress {
 public:
  /// Runs one step, says how long it took, and returns what the step returns. A step that throws
  /// leaves no line: the error's own line is all that is seen.
  template <class Step>
  auto step(const std::string& name, const Step& body) {
    if (on_terminal()) std::fprintf(stderr, "%s …\r", name.c_str());
    const Finish finish{*this, name, Clock::now()};
    return body();
  }

  /// Name and wall milliseconds of each step so far.
  const std::vector<std::pair<std::string, double>>& steps() const { return steps_; }
  double total_ms() const { return milliseconds_since(start_); }

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
  std::vector<std::pair<std::string, double>> steps_;
};

}  // namespace wobblebench::bench
