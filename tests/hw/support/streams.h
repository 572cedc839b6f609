// Small streams of identifiable sticks, for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// Uniform 64-bit hash of seed and index (splitmix64).
std::uint64_t hash(std::uint64_t seed, std::uint64_t index);
/// Uniform in [low, high).
double uniform(std::uint64_t seed, std::uint64_t index, double low, double high);

/// 3 frames of 4 sticks of 5 samples; an odd number, so that sticks are padded.
AcquisitionPlan small_plan(int volumes = 2, MotorMode motor = MotorMode::stepped);

inline constexpr MotorMode kMotorModes[] = {
    MotorMode::stepped, MotorMode::continuous, MotorMode::alternating, MotorMode::fly_back};

/// The stick with number `sequence`, with samples of its own.
Stick test_stick(const AcquisitionPlan& plan, std::uint64_t sequence);

ConfigurationPacket configuration_of(const AcquisitionPlan& plan, std::uint32_t volume);
VolumeEndPacket volume_end_of(const AcquisitionPlan& plan, std::uint32_t volume);

using Bytes = std::vector<std::byte>;

/// All packets of the plan's volumes, in order.
std::vector<Bytes> packets_of(const AcquisitionPlan& plan, WireCrc crc = WireCrc::crc32c);
Bytes join(const std::vector<Bytes>& packets);
Bytes stream_of(const AcquisitionPlan& plan, WireCrc crc = WireCrc::crc32c);

/// A configuration as programs wrote it before there was a display scale.
Bytes without_display_scale(Bytes configuration);

/// The stick equals that of the plan's stream with its sequence number, bit for bit.
bool is_genuine(const AcquisitionPlan& plan, const Stick& stick);

/// Index of a stick in packets_of(): each volume has a configuration before and an end after.
std::size_t packet_index(const AcquisitionPlan& plan, std::uint64_t sequence);

/// For each byte of the plan's stream the sequence number of the stick that it belongs to; -1 in
/// other packets.
std::vector<std::int64_t> owners(const AcquisitionPlan& plan);

}  // namespace wobblebench::hw
