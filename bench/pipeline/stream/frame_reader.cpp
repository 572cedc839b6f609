#include "bench/pipeline/stream/frame_reader.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "base/user_error.h"
#include "hw/probe/beam_width.h"
#include "render/reconstruction/frame_store.h"

namespace wobblebench::bench {

namespace {

/// A board that is stopped wakes next(): the deadline is for boards whose stop was missed.
constexpr std::chrono::seconds kLongestWait{1};

constexpr const char* kChoose =
    "; of a recording, file=RECORDING,acquisition=N takes one (`wobblebench inspect` lists them)";

bool is_same_subject(const hw::Configuration& one, const hw::Configuration& other) {
  return one.subject == other.subject && one.source == other.source;
}

}  // namespace

FrameReader::FrameReader(const StreamSource& source,
                         VolumeQueue& queue,
                         std::uint64_t volumes,
                         bool keep_volume)
    : source_(source),
      plan_(source.plan),
      queue_(queue),
      volumes_(volumes),
      keeps_volume_(keep_volume),
      assembly_(source.board) {
  if (source.configuration) assembly_.configure(*source.configuration);
  statistics_.account = source.before_configuration;
  statistics_.least_free_slots = source.board.ring_slots();
}

void FrameReader::run() {
  try {
    read();
  } catch (...) {
    leave_volume();
    queue_.close();
    throw;
  }
  leave_volume();
  queue_.close();
}

void FrameReader::read() {
  double waited_ms = 0;
  const auto start = hw::HostClock::now();
  for (bool more = true; more;) {
    const auto asked = hw::HostClock::now();
    hw::Event event = source_.board.next(asked + kLongestWait);
    waited_ms += to_milliseconds(hw::HostClock::now() - asked);
    statistics_.least_free_slots =
        std::min(statistics_.least_free_slots, source_.board.free_slots());
    more = has_all() ? take_behind_last(event) : take(event);
    statistics_.busy_ms =
        to_milliseconds(hw::HostClock::now() - start) - waited_ms - queue_.statistics().blocked_ms;
  }
}

bool FrameReader::take(hw::Event& event) {
  if (const auto* slot = std::get_if<hw::StickSlot>(&event)) return take_stick(*slot);
  if (std::holds_alternative<hw::VolumeEnd>(event)) return end_volume() && !has_all();
  if (const auto* configuration = std::get_if<hw::Configuration>(&event)) {
    return end_volume() && !has_all() && take_configuration(*configuration);
  }
  if (const auto* gap = std::get_if<hw::Gap>(&event)) count(*gap);
  if (const std::string why = ending_of(event); !why.empty()) {
    end_stream(why);
    if (!std::holds_alternative<hw::DeviceLost>(event)) return false;
    throw std::runtime_error("--board = " + source_.name + ": " + why);
  }
  return std::holds_alternative<hw::Gap>(event) || std::holds_alternative<hw::TimedOut>(event);
}

/// Those of the gap's sticks that are due before the end of the last wanted volume.
void FrameReader::count(const hw::Gap& gap) {
  hw::Gap wanted = gap;
  if (const auto& volume = assembly_.volume(); volumes_ > 0 && volume) {
    const auto left = static_cast<std::uint32_t>(volumes_ - statistics_.volumes);
    const std::uint64_t end = plan_.first_sequence(volume->volume_index() + left);
    wanted.count = std::min(gap.count, end - std::min(end, gap.first_sequence));
  }
  hw::count_lost(wanted, statistics_.account);
}

/// The event behind the last volume tells whether the stream went on.
bool FrameReader::take_behind_last(const hw::Event& event) {
  if (std::holds_alternative<hw::StickSlot>(event)) {
    ++statistics_.sticks;
    ++statistics_.left_sticks;
  }
  statistics_.ending = ending_of(event);
  return std::holds_alternative<hw::Gap>(event);
}

/// One stream shows one subject on one scale: what scene, renderer and truth were made for.
bool FrameReader::take_configuration(hw::Configuration configuration) {
  configuration.plan = {hw::with_aperture_of(configuration.plan.probe(), plan_.probe()),
                        configuration.plan.acquisition()};
  const auto& before = assembly_.configuration();
  const bool same_plan = configuration.plan.probe() == plan_.probe() &&
                         configuration.plan.acquisition() == hw::with_one_zone(plan_.acquisition());
  const std::uint64_t volumes = statistics_.volumes;
  const std::string text = "--board = " + source_.name + ": behind " + std::to_string(volumes) +
                           (volumes == 1 ? " volume " : " volumes ");
  if (before && !is_same_subject(configuration, *before)) {
    throw UserError(text + "the samples are of another subject" + kChoose);
  }
  const bool same_scale = !before || configuration.display_scale == before->display_scale;
  if (!same_plan || !same_scale) {
    const std::string what = same_plan ? "the display scale changes" : "the acquisition changes";
    end_stream(what);
    throw std::runtime_error(text + what + kChoose);
  }
  // Also where it is another acquisition of the same plan, whose volumes have the same numbers.
  leave_volume();
  late_s_.reset();
  assembly_.configure(configuration);
  return true;
}

bool FrameReader::take_stick(const hw::StickSlot& slot) {
  const hw::Stick& stick = *slot;
  ++statistics_.sticks;
  if (assembly_.is_of_another_volume(stick)) {
    if (!end_volume()) return false;
    leave_volume();
  }
  if (!assembly_.volume()) begin_volume(stick);
  while (assembly_.is_of_later_frame(stick)) {
    if (!finish_frame()) return false;
  }
  frame_.last.received = slot.received();
  frame_.last.acquired = hw::HostClock::now();
  frame_.last.device = stick.time;
  assembly_.place(stick);
  note_time(stick);
  ++statistics_.account.emitted;
  ++statistics_.account.delivered;
  frame_.last.placed = hw::HostClock::now();
  if (frame_.sticks++ == 0) frame_.first = frame_.last;
  const bool is_last =
      static_cast<int>(stick.index.line) + 1 == plan_.acquisition().sticks_per_frame;
  return !is_last || finish_frame();
}

void FrameReader::note_time(const hw::Stick& stick) {
  const double late_s = to_seconds(stick.time.time_since_epoch()) -
                        to_seconds(plan_.stick_time(stick.sequence).time_since_epoch());
  if (!late_s_) late_s_ = late_s;
  statistics_.off_plan_s = std::max(statistics_.off_plan_s, std::abs(late_s - *late_s_));
}

void FrameReader::begin_volume(const hw::Stick& stick) {
  is_first_stick_missed_ =
      !has_begun_ && stick.sequence != plan_.first_sequence(stick.index.volume);
  has_begun_ = true;
  assembly_.begin_volume(stick.index.volume);
  frame_ = {.volume = stick.index.volume, .samples = {}, .first = {}, .last = {}};
}

/// Pushes the frames that did not come.
bool FrameReader::end_volume() {
  while (assembly_.unfinished_frames() > 0) {
    if (!finish_frame()) return false;
  }
  return true;
}

/// No other volume follows the one under way.
void FrameReader::end_stream(const std::string& why) {
  is_first_stick_missed_ = false;
  statistics_.ending = why;
  end_volume();
  if (!finished_.empty()) push_frames();
}

bool FrameReader::finish_frame() {
  frame_.frame = assembly_.finish_frame();
  frame_.ends_volume = assembly_.unfinished_frames() == 0;
  set_times();
  StreamFrame following{.volume = frame_.volume, .samples = {}, .first = {}, .last = {}};
  finished_.push_back(std::exchange(frame_, std::move(following)));
  const bool is_linear = assembly_.volume()->scale() == hw::SampleScale::linear_envelope;
  const bool waits = is_first_stick_missed_ || (is_linear && !finished_.back().ends_volume);
  return waits || push_frames();
}

namespace {

/// Every taker of the frame expects samples as the renderer does. Returns how many were others.
std::uint64_t clamp_samples(std::vector<float>& samples) {
  std::uint64_t clamped = 0;
  for (float& sample : samples) {
    clamped += !(sample >= 0.0f && sample <= 1.0f);
    sample = render::clean_sample(sample);
  }
  return clamped;
}

}  // namespace

bool FrameReader::push_frames() {
  const bool ends_volume = finished_.back().ends_volume;
  if (ends_volume) check_motor();
  if (ends_volume) check_samples();
  for (StreamFrame& frame : finished_) {
    frame.samples = assembly_.volume()->frame(frame.frame);
    statistics_.clamped += clamp_samples(frame.samples.samples);
  }
  if (ends_volume) finish_volume();
  bool is_open = true;
  for (StreamFrame& frame : std::exchange(finished_, {})) {
    is_open = queue_.push(std::move(frame)) && is_open;
  }
  return is_open;
}

void FrameReader::check_motor() {
  const hw::MotorDeviation motor = hw::motor_deviation(*assembly_.volume());
  refuse_misplaced(motor, plan_, source_.name);
  statistics_.motor.add(motor);
}

/// Of the first volume, and of those that are kept; log-compresses linear ones.
void FrameReader::check_samples() {
  hw::PolarVolume& volume = *assembly_.volume();
  const bool is_linear = volume.scale() == hw::SampleScale::linear_envelope;
  if (std::exchange(is_checked_, true) && !keeps_volume_ && !is_linear) return;
  const hw::Configuration& configuration = *assembly_.configuration();
  std::optional<double> range_db;
  if (source_.dynamic_range_db) range_db = source_.dynamic_range_db(configuration.display_scale);
  samples_ = make_displayable(volume, configuration, range_db, source_.name);
}

void FrameReader::finish_volume() {
  hw::PolarVolume volume = assembly_.take_volume().value();
  if (keeps_volume_) kept_ = KeptVolume{std::move(volume), samples_, *assembly_.configuration()};
  ++statistics_.volumes;
}

/// When the frame's first and last stick were due, whether they arrived or not, and what of their
/// times is their own.
void FrameReader::set_times() {
  const auto now = frame_.complete = hw::HostClock::now();
  if (frame_.sticks == 0) {
    frame_.last = {.fired = {},
                   .received = now,
                   .acquired = now,
                   .placed = now,
                   .device = plan_.stick_time(plan_.sequence(
                       {frame_.volume, static_cast<std::uint32_t>(frame_.frame), 0}))};
    frame_.first = frame_.last;
  }
  const auto& arrived = assembly_.volume()->frame(frame_.frame).arrived;
  frame_.first.arrived = arrived.front() != 0;
  frame_.last.arrived = arrived.back() != 0;
  const auto epoch = source_.board.epoch();
  if (!epoch) return;
  const auto lines = static_cast<std::uint64_t>(plan_.acquisition().sticks_per_frame);
  const auto first = plan_.sequence({frame_.volume, static_cast<std::uint32_t>(frame_.frame), 0});
  frame_.first.fired = *epoch + plan_.stick_time(first).time_since_epoch();
  frame_.last.fired = *epoch + plan_.stick_time(first + lines - 1).time_since_epoch();
}

/// What it holds will not be shown.
void FrameReader::leave_volume() {
  if (!assembly_.take_volume()) return;
  statistics_.left_sticks += static_cast<std::uint64_t>(frame_.sticks);
  for (const StreamFrame& frame : finished_) {
    statistics_.left_sticks += static_cast<std::uint64_t>(frame.sticks);
  }
  finished_.clear();
}

void FrameSource::start() {
  if (queue_) return;
  StreamSource source = open_();
  const std::lock_guard lock(starting_);
  source_.emplace(std::move(source)).board.start();
  queue_.emplace(QueueOptions{.policy = StreamPolicy::every});
  if (is_stopped_) queue_->stop();
  thread_ = std::jthread([this] {
    try {
      FrameReader(*source_, *queue_, /*volumes=*/0, /*keep_volume=*/false).run();
    } catch (...) {
      failure_ = std::current_exception();
      queue_->close();
    }
  });
}

std::optional<StreamFrame> FrameSource::next() {
  const std::lock_guard lock(reading_);
  return read_frame();
}

std::optional<StreamFrame> FrameSource::read_frame() {
  start();
  auto frame = queue_->pop();
  if (frame) return frame;
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::nullopt;
}

bool FrameSource::next_volume(const std::function<void(const StreamFrame&)>& take) {
  const std::lock_guard lock(reading_);
  while (const auto frame = read_frame()) {
    take(*frame);
    if (frame->ends_volume) return true;
  }
  return false;
}

void FrameSource::stop() {
  const std::lock_guard lock(starting_);
  is_stopped_ = true;
  if (queue_) queue_->stop();
  if (source_) source_->board.cancel();
}

std::optional<hw::BoardAccount> FrameSource::account() const {
  const std::lock_guard lock(starting_);
  return source_ ? std::optional(source_->board.account()) : std::nullopt;
}

}  // namespace wobblebench::bench
