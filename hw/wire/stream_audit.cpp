#include "hw/wire/stream_audit.h"

#include <cstddef>
#include <optional>
#include <string>

#include "base/options.h"
#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {
namespace {

/// One past the number of any plan's last stick: volumes of 1024 frames of 1024 sticks.
constexpr std::uint64_t kSequenceEnd = std::uint64_t{1} << 52;

AcquisitionPlan plan_of(const ConfigurationPacket& packet) {
  try {
    if (packet.display_scale.stated()) check_options(packet.display_scale);
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
         configuration.display_scale == packet.display_scale;
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

AuditResult StreamAudit::take(const ConfigurationPacket& packet) {
  Configuration configuration{plan_of(packet), packet.source, packet.subject, packet.display_scale};
  const bool repeated = configuration_ && same_plan(*configuration_, packet);
  if (configuration_ && !repeated) tracker_.restart();
  AuditResult result;
  if (fits(configuration.plan, packet)) {
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
