#include "bench/output/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "base/duration.h"
#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

std::string duration_text(double seconds) {
  const long whole = std::lround(seconds);
  if (whole < 100) return std::to_string(whole) + " s";
  return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
}

constexpr const char* kEraseLine = "\r\x1b[K";

/// Starts a thread that no signal is delivered to.
template <class Body>
std::jthread start_without_signals(const Body& body) {
  sigset_t all, before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  std::jthread thread(body);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace

ProgressOutput ProgressOutput::on_stderr() {
  ProgressOutput output;
  output.terminal = ::isatty(STDERR_FILENO) == 1;
  if (output.terminal) output.first = output.every = std::chrono::milliseconds(500);
  return output;
}

Progress::Progress(std::vector<PlannedStep> plan, const ProgressOutput& output)
    : output_(output), left_(std::move(plan), 0) {
  writer_ = start_without_signals([this](const std::stop_token& stop) { write_lines(stop); });
}

Progress::~Progress() = default;

double Progress::now_s() const {
  return to_seconds(Clock::now() - start_);
}

StepTimes Progress::times() const {
  StepTimes times = steps_;
  times.emplace_back("total", 1e3 * now_s());
  return times;
}

void Progress::begin(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  name_ = name;
  note_.clear();
  done_ = all_ = 0;
  begun_s_ = now_s();
  left_.begin(name, begun_s_);
  // Steps shorter than this show no line; many short ones show what is being done all the same.
  if (!line_shown_) next_line_ = Clock::now() + output_.first;
  changed_.notify_one();
}

void Progress::part(std::size_t done, std::size_t all) {
  const std::scoped_lock lock(mutex_);
  if (done < done_) return;  // overtaken by another thread
  done_ = done;
  all_ = all;
  left_.part(static_cast<double>(done) / static_cast<double>(all), now_s());
}

void Progress::note(const std::string& text) {
  const std::scoped_lock lock(mutex_);
  note_ = text;
}

void Progress::warn(const std::string& text) {
  if (text.empty()) return;
  const std::scoped_lock lock(mutex_);
  if (output_.terminal && line_shown_) std::fputs(kEraseLine, output_.file);
  warnings_.push_back(one_line(text));
  std::fprintf(output_.file, "wobblebench: warning: %s\n", warnings_.back().c_str());
  std::fflush(output_.file);
}

std::vector<std::string> Progress::warnings() {
  const std::scoped_lock lock(mutex_);
  return warnings_;
}

MachineUse Progress::machine_use() const {
  return {machine_, sample_machine()};
}

void Progress::finish(bool failed) {
  const std::scoped_lock lock(mutex_);
  if (output_.terminal && line_shown_) std::fputs(kEraseLine, output_.file);
  const double now = now_s();
  if (!failed) {
    const double ms = 1e3 * (now - begun_s_);
    std::fprintf(output_.file, "%-12s %8.0f ms\n", name_.c_str(), ms);
    steps_.emplace_back(name_, ms);
    left_.finish(now);
  }
  std::fflush(output_.file);
  name_.clear();
}

std::string Progress::line() const {
  const double now = now_s();
  std::string text = name_ + ": ";
  if (all_ > 0) text += std::to_string(done_) + " of " + std::to_string(all_) + ", ";
  if (!note_.empty()) text += note_ + ", ";
  text += duration_text(now - begun_s_);
  if (const auto left = left_.seconds(now)) text += ", about " + duration_text(*left) + " left";
  return text;
}

void Progress::write_lines(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    const bool running = !name_.empty();
    if (running && Clock::now() >= next_line_) {
      std::fprintf(output_.file,
                   output_.terminal ? "%s%s" : "%s%s\n",
                   output_.terminal ? kEraseLine : "",
                   line().c_str());
      std::fflush(output_.file);
      line_shown_ = true;
      next_line_ = Clock::now() + output_.every;
    }
    const auto never = [] { return false; };
    if (running) {
      const Clock::time_point until = next_line_;  // it is read while others have the lock
      changed_.wait_until(lock, stop, until, never);
    } else {
      changed_.wait(lock, stop, [this] { return !name_.empty(); });
    }
  }
}

void TimeLeft::begin(const std::string& step, double now_s) {
  if (plan_.empty()) {
    start_s_ = now_s;
    done_share_ = 0;
    return;
  }
  before_ = done_share_;
  const auto here = std::find_if(
      plan_.begin(), plan_.end(), [&](const PlannedStep& one) { return one.name == step; });
  share_ = here == plan_.end() ? 0 : here->share;
  if (here == plan_.end()) return;
  after_ = 0;
  for (auto next = here + 1; next != plan_.end(); ++next) after_ += next->share;
  left_share_ = share_ + after_;
}

void TimeLeft::part(double fraction, double now_s) {
  done_share_ = before_ + fraction * share_;
  left_share_ = (1 - fraction) * share_ + after_;
  part_s_ = now_s;
}

std::optional<double> TimeLeft::seconds(double now_s) const {
  if (done_share_ <= 0) return {};
  const double left = (part_s_ - start_s_) / done_share_ * left_share_ - (now_s - part_s_);
  if (left < 0) return {};
  return left;
}

}  // namespace wobblebench::bench
