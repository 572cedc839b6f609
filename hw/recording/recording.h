// Inspects and salvages recordings, which are files of the bytes of a link.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw/probe/motor_deviation.h"
#include "hw/wire/account.h"
#include "hw/wire/configuration.h"
#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {

/// Bytes of a recording that belong to no packet.
struct DamagedRegion {
  std::uint64_t offset = 0;  ///< in the file
  std::uint64_t bytes = 0;
};

/// Where a recording ends before its bytes do.
struct UnreadablePlace {
  std::uint64_t offset = 0;  ///< in the file, of the packet
  std::string reason;        ///< one line
};

struct RecordedVolume {
  std::uint32_t index = 0;
  std::uint64_t acquisition = 0;  ///< from 1; 0: before any configuration
  std::uint64_t sticks = 0;       ///< intact and in order
  std::uint64_t expected = 0;     ///< of the plan; 0 before any configuration
  bool closed = false;            ///< has a volume_end

  bool whole() const { return closed && acquisition > 0 && sticks == expected; }
};

/// Sticks under one configuration, whose numbers grow. A recording holds several where settings
/// were changed while it was made, or where recordings were joined.
struct RecordedAcquisition {
  Configuration configuration;
  std::uint64_t offset = 0;   ///< in the file, of its first configuration
  std::uint32_t volume = 0;   ///< the first
  std::uint64_t volumes = 0;  ///< of which a packet is there
  std::uint64_t sticks = 0;   ///< intact and in order
  MotorDeviation motor = {};  ///< of them
};

/// The time of a stick, compared with the plan's, jumps by more than half a stick's period.
struct TimeJump {
  std::uint64_t offset = 0;  ///< in the file, of the stick's packet
  std::uint64_t sequence = 0;
  double later_s = 0;  ///< than by the plan; negative: earlier
};

struct RecordingContents {
  std::uint64_t bytes = 0;
  std::uint64_t configurations = 0;
  std::uint64_t sticks = 0;
  std::uint64_t volume_ends = 0;
  std::uint64_t other_packets = 0;                ///< of unknown kinds
  std::optional<Configuration> configuration;     ///< the first
  std::uint64_t acquisition_count = 0;            ///< one after the other
  std::vector<RecordedAcquisition> acquisitions;  ///< the first kListedFaults
  BoardAccount account;
  WireDamage damage;
  std::uint64_t contradictions = 0;            ///< intact packets that contradict the configuration
  std::uint64_t unconfigured = 0;              ///< intact sticks before the first configuration
  std::optional<UnreadablePlace> unreadable;   ///< all else is of the bytes before
  std::vector<DamagedRegion> damaged_regions;  ///< the first kListedFaults
  std::vector<Gap> gaps;                       ///< the first kListedFaults
  std::vector<RecordedVolume> volumes;
  std::uint64_t time_jump_count = 0;
  std::vector<TimeJump> time_jumps;  ///< the first kListedFaults

  static constexpr std::size_t kListedFaults = 4096;

  /// Bytes were lost or changed after the link sent them, the source contradicts its configuration,
  /// no configuration is left to interpret it, or the stream cannot be read to its end.
  bool damaged() const {
    return damage.regions > 0 || contradictions > 0 || !configuration || unreadable;
  }
  /// No stick is missing, and every volume that began is closed.
  bool complete() const;
};

/// Reads the whole file. `progress`, if given, is called every 16 MiB with the bytes read so far.
/// Throws LinkOpenError, and std::runtime_error "PATH: cannot be read: reason".
///
/// @code
/// const hw::RecordingContents contents = hw::inspect_recording("scan.wbst");
/// if (contents.complete() && !contents.damaged()) return;
/// std::vector<std::byte> intact;
/// hw::salvage_recording("scan.wbst", [&](std::span<const std::byte> bytes) {
///   intact.insert(intact.end(), bytes.begin(), bytes.end());
/// });
/// @endcode
RecordingContents inspect_recording(const std::filesystem::path& path,
                                    const std::function<void(std::uint64_t)>& progress = {});

/// Copies the intact packets to `sink`, as a stream without damage: sticks in order, a
/// configuration before the first of each volume (also where its own was damaged), volume ends, of
/// all acquisitions.
/// What is missing stays missing; nothing is taken from an unreadable place on. Throws as
/// inspect_recording(), std::runtime_error where there is no configuration, and what `sink` throws.
void salvage_recording(const std::filesystem::path& path,
                       const std::function<void(std::span<const std::byte>)>& sink);

}  // namespace wobblebench::hw
