// How long a command will still take.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wobblebench::bench {

/// A step that a command will take, and its usual share of the whole time, in any unit.
struct PlannedStep {
  std::string name;
  double share = 1;
};

/// Estimates the time left from the time that the finished parts took. Steps that the plan names
/// and that never come, or come out of order, count as finished when a later one begins. Without a
/// plan the estimate is for the current step alone. Times are seconds on any clock that does not go
/// back.
class TimeLeft {
 public:
  TimeLeft(std::vector<PlannedStep> plan, double now_s) : plan_(std::move(plan)), start_s_(now_s) {}

  void begin(const std::string& step, double now_s);
  /// `fraction` of the current step is finished, in [0, 1].
  void part(double fraction, double now_s);
  void finish(double now_s) { part(1, now_s); }

  /// None before the first part is finished, and where the next takes longer than was expected of
  /// all that was left.
  std::optional<double> seconds(double now_s) const;

 private:
  std::vector<PlannedStep> plan_;
  double start_s_;
  double share_ = 1;       ///< of the current step
  double after_ = 0;       ///< share of the steps after it
  double before_ = 0;      ///< share of the finished steps
  double done_share_ = 0;  ///< at the last part
  double left_share_ = 0;
  double part_s_ = 0;
};

}  // namespace wobblebench::bench
