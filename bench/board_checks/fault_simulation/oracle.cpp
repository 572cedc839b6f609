#include "bench/board_checks/fault_simulation/oracle.h"

#include <bit>
#include <variant>

#include "bench/pipeline/stick_sources.h"
#include "hw/wire/packet.h"

namespace wobblebench::bench {

namespace {

/// Faults that can lose the stick of the packet that they hit.
bool loses_stick(hw::FaultKind kind) {
  return kind == hw::FaultKind::drop || kind == hw::FaultKind::corrupt ||
         kind == hw::FaultKind::truncate || kind == hw::FaultKind::reorder;
}

}  // namespace

void Oracle::check_account(const hw::BoardAccount& account) {
  hash_.add(account.emitted);
  hash_.add(account.delivered);
  if (account.balanced()) return;
  throw RuleViolation("emitted " + std::to_string(account.emitted) + ", delivered " +
                      std::to_string(account.delivered) + " + lost " +
                      std::to_string(account.lost.total()));
}

bool Oracle::check_event(const hw::Event& event) {
  hash_.add(event.index());
  if (const auto* slot = std::get_if<hw::StickSlot>(&event)) {
    check_stick(**slot);
  } else if (const auto* gap = std::get_if<hw::Gap>(&event)) {
    trace("gap " + std::to_string(gap->first_sequence) + " + " + std::to_string(gap->count) + " " +
          hw::to_string(gap->cause));
    hash_.add(static_cast<std::uint64_t>(gap->cause));
    check_sequence(gap->first_sequence, gap->count);
    gaps_.push_back(*gap);
  } else if (const auto* end = std::get_if<hw::VolumeEnd>(&event)) {
    trace("end of volume " + std::to_string(end->volume));
    hash_.add(end->volume);
  } else if (std::holds_alternative<hw::Configuration>(event)) {
    trace("configuration");
    if (!configured_at_) configured_at_ = next_.value_or(0);
  } else if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) {
    trace("lost: " + lost->reason);
    return false;
  } else if (std::holds_alternative<hw::EndOfStream>(event)) {
    trace("end of stream");
    return false;
  }
  return true;
}

void Oracle::check_stick(const hw::Stick& stick) {
  trace("stick " + std::to_string(stick.sequence));
  ++received_;
  check_sequence(stick.sequence, 1);
  if (!configured_at_) throw RuleViolation("a stick before any configuration");
  if (stick.index != scenario_.plan.index(stick.sequence)) {
    throw RuleViolation("stick " + std::to_string(stick.sequence) + " has another stick's index");
  }
  if (stick.time != scenario_.plan.stick_time(stick.sequence)) {
    throw RuleViolation("stick " + std::to_string(stick.sequence) + " has another stick's time");
  }
  check_samples(stick.sequence, stick.samples);
  hash_.add(std::bit_cast<std::uint32_t>(stick.samples.back()));
}

/// Sticks and gaps cover each sequence number once, in order.
void Oracle::check_sequence(std::uint64_t first, std::uint64_t count) {
  hash_.add(first);
  hash_.add(count);
  if (next_ && first != *next_) {
    throw RuleViolation("number " + std::to_string(*next_) + " is due, and " +
                        std::to_string(first) + " comes");
  }
  next_ = first + count;
}

void Oracle::check_samples(std::uint64_t sequence, std::span<const float> samples) const {
  const auto count = static_cast<std::size_t>(scenario_.plan.acquisition().samples_per_stick);
  bool same = samples.size() == count;
  for (std::uint32_t k = 0; same && k < count; ++k) {
    same = std::bit_cast<std::uint32_t>(samples[k]) ==
           std::bit_cast<std::uint32_t>(synthetic_sample(scenario_.seed, sequence, k));
  }
  if (!same)
    throw RuleViolation("stick " + std::to_string(sequence) + " is not what the probe sent");
}

void Oracle::check_volume(const hw::PolarVolume& volume) {
  trace("volume " + std::to_string(volume.volume_index()) + ", " +
        std::to_string(volume.missing_sticks()) + " sticks missing");
  hash_.add(volume.volume_index());
  if (last_volume_ && volume.volume_index() <= *last_volume_) {
    throw RuleViolation("volume " + std::to_string(volume.volume_index()) + " follows volume " +
                        std::to_string(*last_volume_));
  }
  last_volume_ = volume.volume_index();
  const auto& plan = scenario_.plan.acquisition();
  const auto lines = static_cast<std::uint32_t>(plan.sticks_per_frame);
  const auto samples = static_cast<std::size_t>(plan.samples_per_stick);
  for (std::uint32_t frame = 0; frame < volume.frames().size(); ++frame) {
    const hw::PolarFrame& polar = volume.frames()[frame];
    for (std::uint32_t line = 0; line < lines; ++line) {
      hash_.add(polar.arrived[line]);
      if (polar.arrived[line] == 0) continue;
      ++received_;
      check_samples(scenario_.plan.sequence({volume.volume_index(), frame, line}),
                    std::span(polar.samples).subspan(line * samples, samples));
    }
  }
}

void Oracle::check_all_received(const hw::BoardAccount& account) const {
  if (received_ == account.delivered) return;
  throw RuleViolation(std::to_string(account.delivered) + " sticks were delivered, " +
                      std::to_string(received_) + " were seen");
}

void Oracle::check_losses(const std::vector<hw::FaultEvent>& faults,
                          std::uint64_t packets_dropped) const {
  if (packets_dropped > 0) return;
  std::set<std::uint64_t> hit;
  for (const hw::FaultEvent& fault : faults) {
    if (fault.packet_kind == hw::PacketKind::stick && loses_stick(fault.kind)) {
      hit.insert(fault.sequence);
    }
  }
  for (const hw::Gap& gap : gaps_) {
    if (gap.cause == hw::LossCause::ring_full) continue;
    for (std::uint64_t sequence = gap.first_sequence; sequence < gap.first_sequence + gap.count;
         ++sequence) {
      const bool unconfigured = !configured_at_ || sequence < *configured_at_;
      if (unconfigured || hit.contains(sequence)) continue;
      throw RuleViolation("stick " + std::to_string(sequence) + " is lost (" +
                          hw::to_string(gap.cause) + "), and nothing struck it");
    }
  }
}

}  // namespace wobblebench::bench
