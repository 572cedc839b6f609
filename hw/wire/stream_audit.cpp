#include "hw/wire/stream_audit.h"

#include <cstddef>
#include <stdexcept>
#include <string>

#include "base/options.h"

namespace wobblebench::hw {
namespace {

AcquisitionPlan plan_of(const ConfigurationPacket& packet) {
  try {
    return {packet.probe, packet.acquisition};
  } catch (const InvalidOption& error) {
    throw std::runtime_error(std::string("the device's configuration is not possible: ") +
                             error.what());
  }
}

bool same_plan(const Configuration& configuration, const ConfigurationPacket& packet) {
  return configuration.plan.probe() == packet.probe &&
         configuration.plan.acquisition() == packet.acquisition &&
         configuration.source == packet.source && configuration.subject == packet.subject;
}

/// The index lies in the plan and belongs to the sequence number. The stream may continue beyond
/// the plan's number of volumes.
bool index_fits(const AcquisitionPlan& plan, const Stick& stick) {
  return stick.index == plan.index(stick.sequence);
}

bool ends_its_volume(const AcquisitionPlan& plan, const VolumeEndPacket& packet) {
  return packet.sequence ==
         plan.first_sequence(packet.volume) + static_cast<std::uint64_t>(plan.sticks_per_volume());
}

}  // namespace

AuditResult StreamAudit::take(const ConfigurationPacket& packet) {
  Configuration configuration{plan_of(packet), packet.source, packet.subject};
  const bool repeated = configuration_ && same_plan(*configuration_, packet);
  if (configuration_ && !repeated) tracker_.restart();
  AuditResult result{.missing = advance_to(packet.sequence), .rejected = {}, .accepted = !repeated};
  if (!repeated) configuration_ = configuration;
  return result;
}

AuditResult StreamAudit::take(const Stick& stick) {
  AuditResult result;
  if (configuration_ && !index_fits(configuration_->plan, stick)) {
    // The error may be in the sequence number: the next packet shows which stick is missing.
    after_damage_ = true;
    return result;
  }
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
  }
  return result;
}

AuditResult StreamAudit::take(const VolumeEndPacket& packet) {
  AuditResult result;
  if (configuration_ && !ends_its_volume(configuration_->plan, packet)) {
    after_damage_ = true;
    return result;
  }
  result.missing = advance_to(packet.sequence);
  // Not accepted if late or repeated: that volume has ended already.
  result.accepted = inside_volume_ && tracker_.next() == packet.sequence;
  if (result.accepted) inside_volume_ = false;
  return result;
}

std::optional<Gap> StreamAudit::advance_to(std::uint64_t sequence) {
  const std::optional<Gap> gap = tracker_.advance_to(sequence, after_damage_);
  if (gap) inside_volume_ = true;
  if (tracker_.next() == sequence) after_damage_ = false;
  return gap;
}

}  // namespace wobblebench::hw
