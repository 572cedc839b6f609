// Progress on stderr: what is being done, how far it is and how long it will take; one line for
// each finished step with its wall time.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/part_done.h"
#include "bench/output/machine_use.h"
#include "bench/output/report_parts.h"

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

/// The stream that progress is written to, and how often.
struct ProgressOutput {
  std::FILE* file = stderr;
  bool terminal = false;  ///< one line, rewritten
  std::chrono::milliseconds first{2000};
  std::chrono::milliseconds every{5000};

  /// Twice a second on a terminal; in a log after two seconds, then every five.
  static ProgressOutput on_stderr();
};

/// The steps of a command. A thread of its own writes the line, so that no step is silent however
/// long its parts take; signals are never handled on it.
class Progress {
 public:
  /// `plan`: the command's steps, for the time that is left. A step that it does not name has none.
  explicit Progress(std::vector<PlannedStep> plan = {},
                    const ProgressOutput& output = ProgressOutput::on_stderr());
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Runs one step, prints its wall time, and returns its result. The body may take a PartDone,
  /// which any thread may call. A step that throws prints no time.
  template <class Body>
  auto step(const std::string& name, const Body& body) {
    const Running running(*this, name);
    if constexpr (std::is_invocable_v<Body, const PartDone&>) {
      return body(PartDone([this](std::size_t done, std::size_t all) { part(done, all); }));
    } else {
      return body();
    }
  }
  /// What the line says of the current step, besides.
  void note(const std::string& text);

  /// Writes "wobblebench: warning: TEXT" as one line at once, and keeps the text for the report:
  /// what is true, rare, and no reason to refuse; nothing for an empty text. May be called from any
  /// thread.
  void warn(const std::string& text);
  /// In the order in which they were given.
  std::vector<std::string> warnings();

  /// The machine since this was made.
  MachineUse machine_use() const;
  /// Times of the steps so far, in their order.
  const StepTimes& steps() const { return steps_; }
  /// Likewise, and "total": since this was made.
  StepTimes times() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Running {
    Running(Progress& of, const std::string& name) : progress(of) { progress.begin(name); }
    ~Running() { progress.finish(std::uncaught_exceptions() > exceptions); }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;
    Progress& progress;
    int exceptions = std::uncaught_exceptions();
  };

  void begin(const std::string& name);
  void part(std::size_t done, std::size_t all);
  void finish(bool failed);
  void write_lines(const std::stop_token& stop);
  std::string line() const;
  double now_s() const;

  const ProgressOutput output_;
  const Clock::time_point start_ = Clock::now();
  const MachineSample machine_ = sample_machine();
  StepTimes steps_;

  std::mutex mutex_;  ///< of what follows
  std::condition_variable_any changed_;
  TimeLeft left_;
  std::string name_;  ///< empty: between steps
  std::string note_;
  std::vector<std::string> warnings_;
  double begun_s_ = 0;
  std::size_t done_ = 0, all_ = 0;
  Clock::time_point next_line_;
  bool line_shown_ = false;

  std::jthread writer_;
};

}  // namespace wobblebench::bench
