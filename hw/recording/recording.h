// A recording: the bytes of a link in a file. What it holds, and what is wrong with it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "hw/wire/account.h"
#include "hw/wire/packet.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {

/// Bytes of a recording that belong to no packet.
struct DamagedPlace {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
};

struct RecordedVolume {
  std::uint32_t index = 0;
  std::uint64_t sticks = 0;  ///< sound and in order
  bool closed = false;       ///< its volume_end is there
};

struct RecordingContents {
  std::uint64_t bytes = 0;
  std::uint64_t configurations = 0;
  std::uint64_t sticks = 0;
  std::uint64_t volume_ends = 0;
  std::uint64_t other_packets = 0;             ///< of kinds that this program does not know
  std::optional<Configuration> configuration;  ///< the first
  /// False if it holds several acquisitions, one after the other.
  bool one_plan = true;
  BoardAccount account;
  WireDamage damage;
  std::uint64_t contradictions = 0;  ///< sound sticks that contradict the configuration
  std::uint64_t unconfigured = 0;    ///< sound sticks before the first configuration
  /// The first kListedFaults of each.
  std::vector<DamagedPlace> places;
  std::vector<Gap> gaps;
  std::vector<RecordedVolume> volumes;

  static constexpr std::size_t kListedFaults = 4096;

  /// Bytes were lost or changed since the link sent them, or the source sent nonsense.
  bool damaged() const { return damage.places > 0 || contradictions > 0 || !configuration; }
  /// Every stick of every volume is there, each volume closed.
  bool complete() const;
};

/// Reads the whole file. `progress`, if given, is called now and then with the bytes read so far.
/// Throws LinkOpenError where there is no such recording, UnsupportedWireVersion, and
/// std::runtime_error "PATH: cannot be read: reason".
RecordingContents inspect_recording(const std::filesystem::path& path,
                                    const std::function<void(std::uint64_t)>& progress = {});

/// Copies what is sound to `sink`, as a stream that inspects as undamaged: sticks in order, before
/// the first of each volume a configuration (also where its own was damaged), volume ends. What is
/// missing stays missing. Throws as inspect_recording(), and what `sink` throws.
void salvage_recording(const std::filesystem::path& path,
                       const std::function<void(std::span<const std::byte>)>& sink);

}  // namespace wobblebench::hw
