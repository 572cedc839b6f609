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
         configuration.source == packet.source;
}

/// The index lies in the plan, and is the one that the sequence number stands for. The number of
/// volumes is what was asked for; a stream may go on beyond it.
bool index_fits(const AcquisitionPlan& plan, const Stick& stick) {
  return stick.index == plan.index(stick.sequence);
}

bool ends_its_volume(const AcquisitionPlan& plan, const VolumeEndPacket& packet) {
  return packet.sequence ==
         plan.first_sequence(packet.volume) + static_cast<std::uint64_t>(plan.sticks_per_volume());
}

}  // namespace

Audited StreamAudit::take(const ConfigurationPacket& packet) {
  Configuration configuration{plan_of(packet), packet.source};
  const bool repeated = configuration_ && same_plan(*configuration_, packet);
  if (configuration_ && !repeated) ledger_.restart();
  Audited audited{.missing = advance_to(packet.sequence), .refused = {}, .accepted = !repeated};
  if (!repeated) configuration_ = configuration;
  return audited;
}

Audited StreamAudit::take(const Stick& stick) {
  Audited audited;
  if (configuration_ && !index_fits(configuration_->plan, stick)) {
    // Its sequence number may be what is wrong. What follows shows which stick is missing.
    after_damage_ = true;
    return audited;
  }
  const bool damaged = after_damage_;
  audited.missing = advance_to(stick.sequence);
  if (!ledger_.expects(stick.sequence)) return audited;
  inside_volume_ = true;
  if (!configuration_) {
    audited.refused = lose(damaged ? LossCause::corrupt : LossCause::link);
    return audited;
  }
  const auto samples =
      static_cast<std::size_t>(configuration_->plan.acquisition().samples_per_stick);
  if (stick.samples.size() == samples) {
    audited.accepted = true;
  } else {
    audited.refused = lose(LossCause::corrupt);
  }
  return audited;
}

Audited StreamAudit::take(const VolumeEndPacket& packet) {
  Audited audited;
  if (configuration_ && !ends_its_volume(configuration_->plan, packet)) {
    after_damage_ = true;
    return audited;
  }
  audited.missing = advance_to(packet.sequence);
  // Late or repeated: the volume it ends is over.
  audited.accepted = inside_volume_ && ledger_.next() == packet.sequence;
  if (audited.accepted) inside_volume_ = false;
  return audited;
}

std::optional<Gap> StreamAudit::advance_to(std::uint64_t sequence) {
  const std::optional<Gap> gap = ledger_.advance_to(sequence, after_damage_);
  if (gap) inside_volume_ = true;
  if (ledger_.next() == sequence) after_damage_ = false;
  return gap;
}

}  // namespace wobblebench::hw
