#include "tests/hw/support/streams.h"

#include <cmath>

#include "base/hash.h"
#include "hw/wire/layout.h"

namespace wobblebench::hw {

std::uint64_t hash(std::uint64_t seed, std::uint64_t index) {
  return mix64(seed * 0xD1B54A32D192ED03U + (index + 1) * kGoldenGamma);
}

double uniform(std::uint64_t seed, std::uint64_t index, double low, double high) {
  return low + (high - low) * unit_interval(hash(seed, index));
}

AcquisitionPlan small_plan(int volumes, MotorMode motor) {
  AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 4;
  acquisition.samples_per_stick = 5;
  acquisition.frames_per_volume = 3;
  acquisition.volumes = volumes;
  acquisition.motor = motor;
  return {ProbeOptions{}, acquisition};
}

Stick test_stick(const AcquisitionPlan& plan, std::uint64_t sequence) {
  Stick stick;
  schedule(stick, plan, sequence);
  const int samples = plan.acquisition().samples_per_stick;
  for (int k = 0; k < samples; ++k) {
    const auto value = static_cast<float>(hash(sequence, static_cast<std::uint64_t>(k)) >> 40);
    stick.samples.push_back(value / 16777216.0F);
  }
  return stick;
}

ConfigurationPacket configuration_of(const AcquisitionPlan& plan, std::uint32_t volume) {
  const std::uint64_t sequence = plan.first_sequence(volume);
  return {sequence,
          volume,
          plan.stick_time(sequence),
          StreamOrigin::simulated,
          plan.probe(),
          plan.acquisition()};
}

VolumeEndPacket volume_end_of(const AcquisitionPlan& plan, std::uint32_t volume) {
  return {plan.first_sequence(volume + 1), volume, plan.volume_end_time(volume)};
}

std::vector<Bytes> packets_of(const AcquisitionPlan& plan, WireCrc crc) {
  std::vector<Bytes> packets;
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  const auto volumes = static_cast<std::uint32_t>(plan.acquisition().volumes);
  for (std::uint32_t volume = 0; volume < volumes; ++volume) {
    encode(configuration_of(plan, volume), packets.emplace_back());
    for (std::uint64_t i = 0; i < sticks; ++i) {
      encode(test_stick(plan, volume * sticks + i), packets.emplace_back(), crc);
    }
    encode(volume_end_of(plan, volume), packets.emplace_back(), crc);
  }
  return packets;
}

Bytes join(const std::vector<Bytes>& packets) {
  Bytes stream;
  for (const Bytes& packet : packets) stream.insert(stream.end(), packet.begin(), packet.end());
  return stream;
}

Bytes stream_of(const AcquisitionPlan& plan, WireCrc crc) {
  return join(packets_of(plan, crc));
}

Bytes without_display_scale(Bytes configuration) {
  using namespace wire_layout;
  configuration.resize(64 + 160);
  put(configuration.data() + kPayloadBytesOffset, std::uint32_t{160});
  put(configuration.data() + kCrcOffset, packet_crc(configuration));
  return configuration;
}

bool is_genuine(const AcquisitionPlan& plan, const Stick& stick) {
  Bytes expected, actual;
  encode(test_stick(plan, stick.sequence), expected);
  encode(stick, actual);
  return expected == actual;
}

std::size_t packet_index(const AcquisitionPlan& plan, std::uint64_t sequence) {
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  return static_cast<std::size_t>(sequence + 1 + 2 * (sequence / sticks));
}

std::vector<std::int64_t> owners(const AcquisitionPlan& plan) {
  std::vector<std::int64_t> owner;
  std::int64_t sequence = 0;
  for (const Bytes& packet : packets_of(plan)) {
    const bool is_stick = packet[6] == std::byte{2};
    owner.insert(owner.end(), packet.size(), is_stick ? sequence : -1);
    if (is_stick) ++sequence;
  }
  return owner;
}

}  // namespace wobblebench::hw
