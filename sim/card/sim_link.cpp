#include "sim/card/sim_link.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "hw/link/interruptible_wait.h"
#include "hw/wire/packet.h"
#include "sim/card/card_model.h"
#include "sim/card/stick_feed.h"

namespace wobblebench::sim {
namespace {

/// Of the probe's thread, which is woken for all that it waits for.
constexpr std::chrono::seconds kLongestSleep{1};

/// Adds the wall time of computing each block to the statistics.
MakeBlock timed(MakeBlock make, std::shared_ptr<SimLinkStatistics> statistics) {
  return [make = std::move(make), statistics = std::move(statistics)](std::uint64_t first) {
    const auto start = hw::HostClock::now();
    std::vector<float> samples = make(first);
    statistics->volume_ms += to_milliseconds(hw::HostClock::now() - start);
    return samples;
  };
}

}  // namespace

StickSource stick_source(ProbeSimulator simulator,
                         const hw::SubjectHash& subject,
                         const IqSink& iq) {
  const hw::AcquisitionPlan plan = simulator.plan();
  const SimulationOptions options = simulator.options();
  return {plan,
          options.output,
          [simulator = std::move(simulator), iq](std::uint64_t first) {
            if (!iq) return simulator.block(first);
            return simulator.volume(simulator.plan().index(first).volume, iq);
          },
          subject,
          {.full_scale_db = options.full_scale_db,
           .dynamic_range_db = options.dynamic_range_db,
           .tgc_db_per_cm_mhz = options.tgc_db_per_cm_mhz}};
}

class SimLink::Impl {
 public:
  Impl(StickSource source,
       const SimLinkOptions& options,
       std::shared_ptr<SimLinkStatistics> statistics,
       const hw::HostTimeSource* time);

  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline);
  hw::LinkCapabilities capabilities() const;
  std::optional<hw::HostTime> epoch() const { return shared_epoch_.get(); }
  const std::string& loss() const { return loss_; }
  hw::InterruptibleWait& waiting() { return waiting_; }

 private:
  hw::HostTime now() const { return time_ ? time_->now() : hw::HostClock::now(); }
  void set_epoch(hw::HostTime epoch);
  hw::ReadResult read_card(std::span<std::byte> buffer, hw::HostTime deadline);
  std::optional<hw::ReadResult> take_bytes(std::span<std::byte> buffer);
  void fire(const std::stop_token& stop);
  void notify();
  hw::DeviceTime device_now() const;
  void send_until(hw::DeviceTime time);
  bool take_block();
  void begin_volume();
  void delay_probe(hw::DeviceTime begin, hw::HostTime ready);
  void send_stick();
  void end_volume(std::uint32_t volume);
  void push_bytes(hw::DeviceTime time, bool ends_volume);
  hw::DeviceTime stick_end() const;
  hw::HostTime volume_end() const;
  hw::HostTime next_event() const;

  const StickSource source_;
  const SimLinkOptions options_;
  const std::shared_ptr<SimLinkStatistics> statistics_;
  const hw::HostTimeSource* const time_;
  hw::InterruptibleWait waiting_;
  std::string loss_;
  std::mutex mutex_;  ///< of what follows, but for the constants
  std::condition_variable_any changed_;
  bool has_news_ = false;  ///< for probe_: the epoch, or a block
  CardModel card_;
  std::uint64_t sequence_;             ///< of the stick that is sent next
  bool inside_volume_ = false;         ///< its configuration was sent
  bool over_ = false;                  ///< all volumes were sent
  std::vector<float> block_;           ///< samples that were taken from feed_ last
  std::size_t sent_ = 0;               ///< of block_
  hw::Stick stick_;                    ///< the stick sent last
  std::vector<std::byte> bytes_;       ///< one packet
  std::optional<hw::HostTime> epoch_;  ///< host time of device time 0; set by the first read
  hw::SharedEpoch shared_epoch_;       ///< realtime: the same
  const hw::DeviceDuration stick_period_;
  const std::uint64_t first_sequence_;
  StickFeed feed_;      ///< its thread calls notify()
  std::jthread probe_;  ///< last: joined before what it uses is destroyed
};

SimLink::Impl::Impl(StickSource source,
                    const SimLinkOptions& options,
                    std::shared_ptr<SimLinkStatistics> statistics,
                    const hw::HostTimeSource* time)
    : source_(std::move(source)),
      options_(options),
      statistics_(statistics ? std::move(statistics) : std::make_shared<SimLinkStatistics>()),
      time_(time),
      card_(options.card),
      sequence_(source_.plan.first_sequence(static_cast<std::uint32_t>(options.first_volume))),
      stick_period_(std::llround(source_.plan.stick_period_s() * 1e9)),
      first_sequence_(sequence_),
      feed_(timed(source_.block, statistics_),
            source_.plan,
            options.first_volume,
            options.pace == hw::Pace::realtime,
            options.volumes_ahead,
            [this] { notify(); }) {
  check_options(options_);
  if (options_.pace == hw::Pace::realtime && time_ == nullptr) {
    probe_ = std::jthread([this](const std::stop_token& stop) { fire(stop); });
  }
}

hw::LinkCapabilities SimLink::Impl::capabilities() const {
  return {.origin = hw::StreamOrigin::simulated,
          .copy_in = true,
          .waits_for_reader = options_.pace == hw::Pace::asap,
          .buffer_bytes = static_cast<std::size_t>(options_.card.buffer_bytes),
          .buffers = options_.card.buffers,
          .buffers_per_interrupt = options_.card.buffers_per_interrupt};
}

hw::ReadResult SimLink::Impl::read(std::span<std::byte> buffer, hw::HostTime deadline) {
  if (const auto ended = waiting_.interrupted()) return {0, *ended};
  try {
    return read_card(buffer, deadline);
  } catch (const std::exception& error) {
    loss_ = std::string("the simulation failed: ") + error.what();
    return {0, hw::ReadStatus::lost};
  }
}

hw::ReadResult SimLink::Impl::read_card(std::span<std::byte> buffer, hw::HostTime deadline) {
  for (;;) {
    const std::uint64_t wakes = waiting_.wakes();
    hw::HostTime event;
    {
      const std::lock_guard lock(mutex_);
      if (!epoch_) {
        set_epoch(now() - source_.plan.stick_time(first_sequence_).time_since_epoch());
      }
      if (const auto taken = take_bytes(buffer)) return *taken;
      event = next_event();
    }
    if (deadline <= now()) return {0, hw::ReadStatus::timeout};
    waiting_.sleep_until(std::min(deadline, event), wakes);
    if (const auto ended = waiting_.interrupted()) return {0, *ended};
  }
}

/// What a read returns at once; none: it has to wait.
std::optional<hw::ReadResult> SimLink::Impl::take_bytes(std::span<std::byte> buffer) {
  send_until(device_now());
  const std::size_t bytes = card_.read(buffer, device_now());
  if (bytes > 0) return hw::ReadResult{bytes, hw::ReadStatus::ok};
  if (!over_ || card_.next_interrupt()) return std::nullopt;
  return hw::ReadResult{0, hw::ReadStatus::end_of_stream};
}

/// The thread of a probe in real time, which fires on while nobody reads: each volume is taken from
/// the feed when it is due, so that the next one is computed meanwhile, and none is late for want
/// of a reader.
void SimLink::Impl::fire(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  try {
    while (!stop.stop_requested() && !over_) {
      if (epoch_) send_until(device_now());
      hw::HostTime wake = hw::HostClock::now() + kLongestSleep;
      if (epoch_ && inside_volume_) wake = std::min(wake, volume_end());
      changed_.wait_until(lock, stop, wake, [this] { return std::exchange(has_news_, false); });
    }
  } catch (const std::exception&) {  // read() comes to it, too
  }
}

/// A block is ready.
void SimLink::Impl::notify() {
  waiting_.wake();
  const std::lock_guard lock(mutex_);
  has_news_ = true;
  changed_.notify_all();
}

void SimLink::Impl::set_epoch(hw::HostTime epoch) {
  epoch_ = epoch;
  has_news_ = true;
  changed_.notify_all();
  if (options_.pace == hw::Pace::realtime) shared_epoch_.set(epoch);
}

/// asap: every interrupt lies in the past.
hw::DeviceTime SimLink::Impl::device_now() const {
  if (options_.pace == hw::Pace::asap) return hw::DeviceTime::max();
  return hw::DeviceTime(now() - *epoch_);
}

/// Time of the next interrupt or end of a stick. A block that becomes ready ends a sleep earlier.
hw::HostTime SimLink::Impl::next_event() const {
  if (options_.pace == hw::Pace::asap) return hw::HostTime::max();
  hw::DeviceTime event = hw::DeviceTime::max();
  if (const auto interrupt = card_.next_interrupt()) event = *interrupt;
  if (!over_ && inside_volume_) event = std::min(event, stick_end());
  if (event == hw::DeviceTime::max()) return hw::HostTime::max();
  return *epoch_ + event.time_since_epoch();
}

/// Sends the sticks that are complete at `time`; asap: until there are bytes to read.
void SimLink::Impl::send_until(hw::DeviceTime time) {
  const bool asap = options_.pace == hw::Pace::asap;
  while (!over_) {
    if (asap && card_.next_interrupt()) return;
    if (sent_ == block_.size() && !take_block()) return;
    if (!inside_volume_) begin_volume();
    if (stick_end() > time) return;
    send_stick();
  }
}

/// False: the next samples are not ready.
bool SimLink::Impl::take_block() {
  if (!feed_.ready()) return false;
  auto next = feed_.take();
  block_ = std::move(next.samples);
  sent_ = 0;
  if (!inside_volume_) delay_probe(source_.plan.stick_time(sequence_), next.ready_at);
  return true;
}

/// Sends the configuration of the next volume.
void SimLink::Impl::begin_volume() {
  const hw::AcquisitionPlan& plan = source_.plan;
  const hw::DeviceTime begin = plan.stick_time(sequence_);
  bytes_.clear();
  hw::encode(hw::ConfigurationPacket{.sequence = sequence_,
                                     .volume = plan.index(sequence_).volume,
                                     .time = begin,
                                     .source = hw::StreamOrigin::simulated,
                                     .probe = plan.probe(),
                                     .acquisition = plan.acquisition(),
                                     .subject = source_.subject,
                                     .display_scale = source_.display_scale},
             bytes_);
  push_bytes(begin, false);
  inside_volume_ = true;
}

/// Moves the epoch so that a volume does not begin before its samples are ready. The first volume
/// is never late: it is the start.
void SimLink::Impl::delay_probe(hw::DeviceTime begin, hw::HostTime ready) {
  const hw::HostTime due = *epoch_ + begin.time_since_epoch();
  if (time_ != nullptr || ready <= due) return;
  set_epoch(*epoch_ + (ready - due));
  if (sequence_ > first_sequence_) statistics_->late_ms += to_milliseconds(ready - due);
}

void SimLink::Impl::push_bytes(hw::DeviceTime time, bool ends_volume) {
  card_.push(bytes_, time, ends_volume);
  statistics_->packets_dropped = card_.packets_dropped();
}

hw::DeviceTime SimLink::Impl::stick_end() const {
  return source_.plan.stick_time(sequence_) + stick_period_;
}

/// When all sticks of the volume under way are fired.
hw::HostTime SimLink::Impl::volume_end() const {
  const hw::AcquisitionPlan& plan = source_.plan;
  const auto next = plan.first_sequence(plan.index(sequence_).volume) +
                    static_cast<std::uint64_t>(plan.sticks_per_volume());
  return *epoch_ + (plan.stick_time(next - 1) + stick_period_).time_since_epoch();
}

void SimLink::Impl::send_stick() {
  const hw::AcquisitionPlan& plan = source_.plan;
  const auto samples = static_cast<std::size_t>(plan.acquisition().samples_per_stick);
  const auto per_volume = static_cast<std::uint64_t>(plan.sticks_per_volume());
  const auto stick_samples = std::span(block_).subspan(sent_, samples);
  sent_ += samples;
  hw::schedule(stick_, plan, sequence_);
  stick_.scale = source_.scale;
  stick_.samples.assign(stick_samples.begin(), stick_samples.end());
  bytes_.clear();
  hw::encode(stick_, bytes_);
  push_bytes(stick_end(), false);
  ++sequence_;
  ++statistics_->sticks_emitted;
  if (sequence_ % per_volume == 0) end_volume(stick_.index.volume);
}

void SimLink::Impl::end_volume(std::uint32_t volume) {
  const hw::DeviceTime end = source_.plan.volume_end_time(volume);
  bytes_.clear();
  hw::encode(hw::VolumeEndPacket{.sequence = sequence_, .volume = volume, .time = end}, bytes_);
  push_bytes(end, true);
  inside_volume_ = false;
  const int volumes = options_.first_volume + source_.plan.acquisition().volumes;
  over_ = volume + 1 == static_cast<std::uint32_t>(volumes);
}

SimLink::SimLink(StickSource source,
                 const SimLinkOptions& options,
                 std::shared_ptr<SimLinkStatistics> statistics,
                 const hw::HostTimeSource* time)
    : impl_(std::make_unique<Impl>(std::move(source), options, std::move(statistics), time)) {}

SimLink::~SimLink() = default;

hw::ReadResult SimLink::read(std::span<std::byte> buffer, hw::HostTime deadline) {
  return impl_->read(buffer, deadline);
}

void SimLink::cancel() {
  impl_->waiting().cancel();
}

void SimLink::resume() {
  impl_->waiting().resume();
}

void SimLink::close() {
  impl_->waiting().close();
}

hw::LinkCapabilities SimLink::capabilities() const {
  return impl_->capabilities();
}

std::optional<hw::HostTime> SimLink::epoch() const {
  return impl_->epoch();
}

std::string SimLink::loss() const {
  return impl_->loss().empty() ? Link::loss() : impl_->loss();
}

}  // namespace wobblebench::sim
