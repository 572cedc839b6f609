#include "hw/wire/stream_audit.h"

#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/options.h"
#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {

namespace {

constexpr std::size_t kRememberedGaps = 1024;

/// One past the number of any plan's last stick: volumes of 1024 frames of 1024 sticks.
constexpr std::uint64_t kSequenceEnd = std::uint64_t{1} << 52;

AcquisitionPlan plan_of(const ConfigurationPacket& packet) {
  try {
    if (packet.display_scale.knows_range()) check_options(packet.display_scale);
    return {packet.probe, packet.acquisition};
  } catch (const InvalidOption& error) {
    throw UnreadableStream(std::string("the device's configuration is not possible: ") +
                           error.what());
  }
}

bool same_plan(const Configuration& configuration, const ConfigurationPacket& packet) {
  return configuration.plan.probe() == packet.probe &&
         configuration.plan.acquisition() == packet.acquisition &&
         configuration.source == packet.source && configuration.subject == packet.subject &&
         configuration.display_scale == packet.display_scale &&
         configuration.knows_times == packet.knows_times;
}

// The stream may continue beyond the plan's number of volumes. Before a configuration any number is
// taken that some plan has.

bool fits(const AcquisitionPlan& plan, const ConfigurationPacket& packet) {
  return plan.has_stick(packet.sequence) && plan.index(packet.sequence).volume == packet.volume;
}

bool fits(const std::optional<Configuration>& configuration, const Stick& stick) {
  if (!configuration) return stick.sequence < kSequenceEnd;
  const AcquisitionPlan& plan = configuration->plan;
  return plan.has_stick(stick.sequence) && stick.index == plan.index(stick.sequence);
}

bool fits(const std::optional<Configuration>& configuration, const VolumeEndPacket& packet) {
  if (!configuration) return packet.sequence <= kSequenceEnd;
  const AcquisitionPlan& plan = configuration->plan;
  return packet.sequence ==
         plan.first_sequence(packet.volume) + static_cast<std::uint64_t>(plan.sticks_per_volume());
}

}  // namespace

std::uint64_t& SequenceTracker::counter(LossCause cause) {
  switch (cause) {
    case LossCause::ring_full:
      return account_.lost.ring_full;
    case LossCause::link:
      return account_.lost.link;
    case LossCause::corrupt:
      return account_.lost.corrupt;
    case LossCause::out_of_order:
      return account_.lost.out_of_order;
  }
  throw std::logic_error("unknown cause of loss");
}

std::optional<Gap> SequenceTracker::advance_to(std::uint64_t sequence, bool after_damage) {
  if (!next_) next_ = sequence;
  if (sequence <= *next_) return {};
  const Gap gap{*next_, sequence - *next_, after_damage ? LossCause::corrupt : LossCause::link};
  if (gap.count >= std::numeric_limits<std::uint64_t>::max() - account_.emitted) {
    throw UnreadableStream("its sequence numbers say that 2^64 sticks were emitted");
  }
  account_.emitted += gap.count;
  counter(gap.cause) += gap.count;
  next_ = sequence;
  missing_[gap.first_sequence] = {gap.count, gap.cause};
  forget_old_gaps();
  return gap;
}

bool SequenceTracker::expects(std::uint64_t sequence) {
  if (next_ == sequence) return true;
  if (!reclassify_missing(sequence)) ++account_.duplicates;
  return false;
}

bool SequenceTracker::reclassify_missing(std::uint64_t sequence) {
  auto after = missing_.upper_bound(sequence);
  if (after == missing_.begin()) return false;
  const auto [first, missing] = *std::prev(after);
  const std::uint64_t offset = sequence - first;
  if (offset >= missing.count) return false;
  missing_.erase(first);
  if (offset > 0) missing_[first] = {offset, missing.cause};
  if (offset + 1 < missing.count)
    missing_[sequence + 1] = {missing.count - offset - 1, missing.cause};
  forget_old_gaps();
  --counter(missing.cause);
  ++account_.lost.out_of_order;
  return true;
}

void SequenceTracker::forget_old_gaps() {
  while (missing_.size() > kRememberedGaps) missing_.erase(missing_.begin());
}

void SequenceTracker::deliver() {
  ++account_.emitted;
  ++account_.delivered;
  ++next_.value();
}

Gap SequenceTracker::lose(LossCause cause) {
  ++account_.emitted;
  ++counter(cause);
  return {next_.value()++, 1, cause};
}

void SequenceTracker::restart() {
  next_.reset();
  missing_.clear();
}

AuditResult StreamAudit::take(const ConfigurationPacket& packet) {
  Configuration configuration{
      plan_of(packet), packet.source, packet.subject, packet.display_scale, packet.knows_times};
  const bool has_its_number = fits(configuration.plan, packet);
  const bool restarts = has_its_number && goes_back(packet.sequence);
  const bool repeated = configuration_ && same_plan(*configuration_, packet) && !restarts;
  if (restarts || (configuration_ && !repeated)) {
    tracker_.restart();
    inside_volume_ = false;
  }
  AuditResult result;
  if (has_its_number) {
    result.missing = advance_to(packet.sequence);
  } else {
    result = contradiction();
  }
  result.accepted = !repeated;
  if (!repeated) configuration_ = configuration;
  return result;
}

AuditResult StreamAudit::take(const Stick& stick) {
  if (!fits(configuration_, stick)) return contradiction();
  AuditResult result;
  const bool damaged = after_damage_;
  result.missing = advance_to(stick.sequence);
  if (!tracker_.expects(stick.sequence)) return result;
  inside_volume_ = true;
  if (!configuration_) {
    result.rejected = lose(damaged ? LossCause::corrupt : LossCause::link);
    return result;
  }
  const auto samples =
      static_cast<std::size_t>(configuration_->plan.acquisition().samples_per_stick);
  if (stick.samples.size() == samples) {
    result.accepted = true;
  } else {
    result.rejected = lose(LossCause::corrupt);
    result.contradicts = true;
  }
  return result;
}

AuditResult StreamAudit::take(const VolumeEndPacket& packet) {
  if (!fits(configuration_, packet)) return contradiction();
  AuditResult result;
  result.missing = advance_to(packet.sequence);
  // Not accepted if late or repeated: that volume has ended already.
  result.accepted = inside_volume_ && tracker_.next() == packet.sequence;
  if (result.accepted) inside_volume_ = false;
  return result;
}

bool StreamAudit::goes_back(std::uint64_t sequence) const {
  const std::uint64_t next = next_sequence();
  return sequence < next && next - sequence > kMostLateSticks;
}

/// The error may be in the sequence number: the next packet shows which sticks are missing.
AuditResult StreamAudit::contradiction() {
  after_damage_ = true;
  return {.missing = {}, .rejected = {}, .accepted = false, .contradicts = true};
}

std::optional<Gap> StreamAudit::advance_to(std::uint64_t sequence) {
  const std::optional<Gap> gap = tracker_.advance_to(sequence, after_damage_);
  if (gap) inside_volume_ = true;
  if (tracker_.next() == sequence) after_damage_ = false;
  return gap;
}

}  // namespace wobblebench::hw
