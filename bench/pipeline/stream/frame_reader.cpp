#include "bench/pipeline/stream/frame_reader.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "base/user_error.h"
#include "bench/pipeline/display_samples.h"

namespace wobblebench::bench {

namespace {

/// A board that is stopped wakes next(): the deadline is for boards whose stop was missed.
constexpr std::chrono::seconds kLongestWait{1};

double milliseconds(hw::HostClock::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

}  // namespace

FrameReader::FrameReader(hw::Board& board,
                         const hw::AcquisitionPlan& plan,
                         VolumeQueue& queue,
                         std::string source)
    : board_(board), plan_(plan), queue_(queue), source_(std::move(source)) {
  statistics_.least_free_slots = board.ring_slots();
}

void FrameReader::run(std::uint64_t volumes) {
  try {
    read(volumes);
  } catch (...) {
    leave_volume();
    queue_.close();
    throw;
  }
  leave_volume();
  queue_.close();
}

void FrameReader::read(std::uint64_t volumes) {
  double waited_ms = 0;
  const auto start = hw::HostClock::now();
  for (bool more = true; more && (volumes == 0 || statistics_.volumes < volumes);) {
    const auto asked = hw::HostClock::now();
    hw::Event event = board_.next(asked + kLongestWait);
    waited_ms += milliseconds(hw::HostClock::now() - asked);
    statistics_.least_free_slots = std::min(statistics_.least_free_slots, board_.free_slots());
    more = take(event);
    statistics_.busy_ms =
        milliseconds(hw::HostClock::now() - start) - waited_ms - queue_.statistics().blocked_ms;
  }
}

bool FrameReader::take(hw::Event& event) {
  if (const auto* slot = std::get_if<hw::StickSlot>(&event)) return take_stick(**slot);
  if (std::holds_alternative<hw::VolumeEnd>(event)) return end_volume();
  if (const auto* configuration = std::get_if<hw::Configuration>(&event)) {
    const bool same = configuration->plan.probe() == plan_.probe() &&
                      configuration->plan.acquisition() == hw::with_one_zone(plan_.acquisition());
    if (!same) throw std::runtime_error("--board = " + source_ + ": the acquisition changes");
    return end_volume();
  }
  if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) {
    end_volume();
    throw std::runtime_error("--board = " + source_ + ": " + lost->reason);
  }
  if (std::holds_alternative<hw::EndOfStream>(event)) {
    end_volume();
    return false;
  }
  return std::holds_alternative<hw::Gap>(event) || std::holds_alternative<hw::TimedOut>(event);
}

bool FrameReader::take_stick(const hw::Stick& stick) {
  ++statistics_.sticks;
  if (volume_ && volume_->volume_index() != stick.index.volume && !end_volume()) return false;
  if (!volume_ && !begin_volume(stick)) return true;
  const int place_of_stick = place(static_cast<int>(stick.index.frame), stick.index.volume);
  while (next_ < place_of_stick) {
    if (!push_frame(false)) return false;
  }
  frame_.last.acquired = hw::HostClock::now();
  if (frame_.sticks++ == 0) frame_.first.acquired = frame_.last.acquired;
  volume_->place(stick);
  const bool is_last =
      static_cast<int>(stick.index.line) + 1 == plan_.acquisition().sticks_per_frame;
  return !is_last || push_frame(next_ + 1 == plan_.acquisition().frames_per_volume);
}

/// False: the stick belongs to a volume that is left out.
bool FrameReader::begin_volume(const hw::Stick& stick) {
  const bool is_first_volume = statistics_.volumes == 0 && !missed_;
  if (is_first_volume && stick.sequence != plan_.first_sequence(stick.index.volume)) {
    missed_ = stick.index.volume;
  }
  if (missed_ == stick.index.volume) {
    ++statistics_.left_sticks;
    return false;
  }
  if (stick.scale != hw::SampleScale::log_compressed) {
    throw UserError("--board = " + source_ +
                    ": its samples are linear envelopes; a stream must be log-compressed "
                    "(simulation.output = \"log\")");
  }
  volume_.emplace(plan_, stick.index.volume);
  next_ = 0;
  frame_ = {.volume = stick.index.volume, .samples = {}, .first = {}, .last = {}};
  return true;
}

/// Pushes the frames that did not come.
bool FrameReader::end_volume() {
  const int frames = plan_.acquisition().frames_per_volume;
  while (volume_) {
    if (!push_frame(next_ + 1 == frames)) return false;
  }
  return true;
}

bool FrameReader::push_frame(bool ends_volume) {
  frame_.frame = place(next_++, frame_.volume);
  frame_.samples = volume_->frame(frame_.frame);
  frame_.ends_volume = ends_volume;
  set_schedule();
  if (frame_.sticks == 0) frame_.first.acquired = frame_.last.acquired = hw::HostClock::now();
  StreamFrame following{.volume = frame_.volume, .samples = {}, .first = {}, .last = {}};
  StreamFrame done = std::exchange(frame_, std::move(following));
  if (ends_volume) {
    if (!std::exchange(checked_, true)) {
      make_displayable(*volume_, hw::StreamOrigin::simulated, {}, source_);
    }
    volume_.reset();
    ++statistics_.volumes;
  }
  return queue_.push(std::move(done));
}

/// When the frame's first and last stick were due, whether they arrived or not.
void FrameReader::set_schedule() {
  const auto epoch = board_.epoch();
  if (!epoch) return;
  const auto lines = static_cast<std::uint64_t>(plan_.acquisition().sticks_per_frame);
  const auto first = plan_.sequence({frame_.volume, static_cast<std::uint32_t>(frame_.frame), 0});
  frame_.first.fired = *epoch + plan_.stick_time(first).time_since_epoch();
  frame_.last.fired = *epoch + plan_.stick_time(first + lines - 1).time_since_epoch();
}

int FrameReader::place(int frame, std::uint32_t volume) const {
  return plan_.sweep_direction(volume) > 0 ? frame
                                           : plan_.acquisition().frames_per_volume - 1 - frame;
}

/// What the frame under way holds will not be shown.
void FrameReader::leave_volume() {
  if (volume_) statistics_.left_sticks += static_cast<std::uint64_t>(frame_.sticks);
}

}  // namespace wobblebench::bench
