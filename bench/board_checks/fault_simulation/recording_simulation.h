// Fault simulation of a recording: recorded, killed, cut anywhere, inspected, salvaged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bench/board_checks/fault_simulation/oracle.h"
#include "bench/board_checks/fault_simulation/scenario.h"
#include "hw/recording/recorder.h"
#include "hw/recording/recording.h"
#include "hw/wire/packet.h"

namespace wobblebench::bench {

/// A packet of the probe, whole and unchanged.
struct FoundPacket {
  hw::PacketKind kind;
  std::uint64_t sequence;
  std::size_t begin;  ///< offset of its first byte
  std::size_t end;    ///< offset after its last byte
};

/// Knows the packets that the probe sent, and finds them in a recording by comparing bytes, without
/// the decoder, CRCs or the audit. Each check throws RuleViolation.
class RecordingOracle {
 public:
  using Bytes = std::span<const std::byte>;
  explicit RecordingOracle(const Scenario& scenario);

  /// In their order, copies of a packet too.
  std::vector<FoundPacket> find(Bytes bytes) const;

  /// `kept`: what the sink got of `received`, the bytes that all reads of the link returned but one
  /// that the recorder was killed in. It is their beginning, with each whole packet of them; where
  /// the recording ended by itself, all of them, or up to the last of `volumes` volume ends (beyond
  /// it only where damage hid the end from the recorder for a packet's length).
  void check_kept(Bytes received, Bytes kept, bool killed, int volumes) const;
  /// The recorder's account, of all that was received.
  void check_account(Bytes received, const hw::RecordingProgress& progress) const;
  /// `contents`: of these bytes; unset: they were refused as no recording.
  void check_inspection(Bytes recorded, const std::optional<hw::RecordingContents>& contents) const;
  /// `salvaged`: each stick that was sent before all that follow it is there once, in order, and
  /// nothing is damaged. `again`, the salvage of it, is the same. Returns the number of sticks.
  std::uint64_t check_salvage(Bytes recorded,
                              Bytes salvaged,
                              const std::optional<hw::RecordingContents>& contents,
                              Bytes again) const;

 private:
  /// Numbers of the sticks that did not come after later ones. `from_configuration`: only those
  /// after the first configuration.
  std::vector<std::uint64_t> in_order(Bytes bytes, bool from_configuration) const;

  struct Sent {
    hw::PacketKind kind;
    std::uint64_t sequence;
    std::vector<std::byte> bytes;
  };
  std::vector<Sent> sent_;  ///< by time
};

struct RecordingSimulationResult {
  std::uint64_t hash = 0;  ///< of the recorded bytes and what is made of them
  std::uint64_t bytes_recorded = 0;
  std::uint64_t sticks_salvaged = 0;
  std::string failure;  ///< the rule violated; empty: none
};

/// Records the scenario's link through hw::Recorder into memory, with reads of any length. A kill
/// at any read leaves what the recorder gave away until then, cut at any byte. RecordingOracle
/// checks the recorder, the inspection of the rest, its salvage, and the salvage of that.
RecordingSimulationResult simulate_recording(const Scenario& scenario, const Oracle::Trace& trace);

}  // namespace wobblebench::bench
