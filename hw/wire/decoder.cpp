#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "hw/wire/decoder.h"
#include "hw/wire/layout.h"

namespace wobblebench::hw {

using namespace wire_layout;

namespace {

std::optional<Packet> parse_configuration(Bytes packet) {
  const Bytes payload = packet.subspan(kWireHeaderBytes);
  const auto motor = get<std::uint32_t>(payload, kMotorModeOffset);
  const auto source = get<std::uint32_t>(payload, kSourceOffset);
  if (motor > static_cast<std::uint32_t>(MotorMode::fly_back)) return {};
  if (source < static_cast<std::uint32_t>(StreamOrigin::simulated) ||
      source > static_cast<std::uint32_t>(StreamOrigin::hardware)) {
    return {};
  }
  ConfigurationPacket parsed;
  const PacketStamp stamp = packet_stamp(packet);
  parsed.sequence = stamp.sequence;
  parsed.volume = stamp.volume;
  parsed.time = stamp.time;
  parsed.source = static_cast<StreamOrigin>(source);
  parsed.acquisition.motor = static_cast<MotorMode>(motor);
  visit_configuration(parsed, [&](std::size_t offset, auto& value) {
    if (offset >= payload.size()) return;  // from before the display scale
    value = get<std::remove_reference_t<decltype(value)>>(payload, offset);
  });
  return parsed;
}

std::optional<Packet> parse_stick(Bytes packet) {
  Stick stick;
  const PacketStamp stamp = packet_stamp(packet);
  stick.sequence = stamp.sequence;
  stick.index = {stamp.volume,
                 get<std::uint32_t>(packet, kFrameOffset),
                 get<std::uint32_t>(packet, kLineOffset)};
  stick.time = stamp.time;
  stick.motor_angle_rad = get<double>(packet, kMotorAngleOffset);
  stick.sweep_direction = get<std::int32_t>(packet, kSweepDirectionOffset);
  // The following stick needs a number, too.
  if (stick.sequence == std::numeric_limits<std::uint64_t>::max()) return {};
  if (!std::isfinite(stick.motor_angle_rad)) return {};
  if (stick.sweep_direction != 1 && stick.sweep_direction != -1) return {};
  const bool linear = (get<std::uint32_t>(packet, kFlagsOffset) & kFlagLinearEnvelope) != 0;
  stick.scale = linear ? SampleScale::linear_envelope : SampleScale::log_compressed;
  stick.checked = (get<std::uint32_t>(packet, kFlagsOffset) & kFlagCrcUnchecked) == 0;
  stick.samples.resize(get<std::uint32_t>(packet, kSamplesOffset));
  get_floats(packet.subspan(kWireHeaderBytes), stick.samples);
  return StickPacket{std::move(stick)};
}

std::optional<Packet> parse_volume_end(Bytes packet) {
  const PacketStamp stamp = packet_stamp(packet);
  return VolumeEndPacket{stamp.sequence, stamp.volume, stamp.time};
}

}  // namespace

std::optional<Packet> parse_packet(Bytes packet) {
  switch (packet_kind(packet)) {
    case PacketKind::configuration:
      return parse_configuration(packet);
    case PacketKind::stick:
      return parse_stick(packet);
    case PacketKind::volume_end:
      return parse_volume_end(packet);
  }
  return {};
}

std::optional<Packet> Decoder::next() {
  while (!later_version_) {
    const auto frame = framer_.next();
    if (!frame) return {};
    if (packet_version(frame->bytes) != kWireVersion) {
      later_version_ = packet_version(frame->bytes);
      break;
    }
    // Of a later revision; takes no sequence number.
    if (!is_known_kind(frame->bytes)) continue;
    if (auto parsed = parse_packet(frame->bytes)) return parsed;
    framer_.reject_last();
  }
  throw UnsupportedWireVersion(*later_version_);
}

}  // namespace wobblebench::hw
