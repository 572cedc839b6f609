// The oracle of the fault simulation: what the program receives is checked against what the probe
// sent.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/board_checks/fault_simulation/scenario.h"
#include "hw/board/board.h"
#include "hw/link/fault_link.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// what() is the rule that was violated, with the values.
struct RuleViolation : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Of a sequence of numbers.
class EventHash {
 public:
  void add(std::uint64_t value) {
    hash_ = (hash_ ^ value) * 0x9FB21C651E98DF25;
    hash_ ^= hash_ >> 32;
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0x243F6A8885A308D3;
};

/// Each check throws RuleViolation, and adds its values to the hash.
class Oracle {
 public:
  using Trace = std::function<void(const std::string&)>;
  Oracle(const Scenario& scenario, Trace trace) : scenario_(scenario), trace_(std::move(trace)) {}

  void add_action(int action) { hash_.add(static_cast<std::uint64_t>(action)); }
  void check_account(const hw::BoardAccount& account);
  /// False at the end of the stream.
  [[nodiscard]] bool check_event(const hw::Event& event);
  void check_volume(const hw::PolarVolume& volume);

  /// Every stick lost was hit by a fault, dropped by a full ring, or before the first
  /// configuration. Only where events are taken one by one.
  void check_losses(const std::vector<hw::FaultEvent>& faults, std::uint64_t packets_dropped) const;
  /// Every stick delivered was received, one by one or in volumes.
  void check_all_received(const hw::BoardAccount& account) const;

  std::uint64_t hash() const { return hash_.value(); }

 private:
  void check_stick(const hw::Stick& stick);
  void check_sequence(std::uint64_t first, std::uint64_t count);
  void check_samples(std::uint64_t sequence, std::span<const float> samples) const;
  void trace(const std::string& line) const {
    if (trace_) trace_(line);
  }

  const Scenario& scenario_;
  const Trace trace_;
  EventHash hash_;
  std::optional<std::uint64_t> next_;  ///< sequence number expected next
  std::optional<std::uint64_t>
      configured_at_;  ///< expected sequence number at the first configuration
  std::vector<hw::Gap> gaps_;
  std::optional<std::uint32_t> last_volume_;
  std::uint64_t received_ = 0;  ///< sticks
};

}  // namespace wobblebench::bench
