// Watches a rehearsal: what the program is given, against what the probe sent.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/checks/fault_simulation/scenario.h"
#include "hw/board/board.h"
#include "hw/link/fault_link.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// A rule did not hold.
struct RuleBroken : std::runtime_error {
  using std::runtime_error::runtime_error;
};

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

class Oracle {
 public:
  using Trace = std::function<void(const std::string&)>;
  Oracle(const Scenario& scenario, Trace trace) : scenario_(scenario), trace_(std::move(trace)) {}

  void step(int what) { hash_.add(static_cast<std::uint64_t>(what)); }
  void account(const hw::BoardAccount& account);
  /// False where the stream is over.
  bool event(const hw::Event& event);
  void volume(const hw::PolarVolume& volume);

  /// Whether all that is missing is explained by what struck it. Only for events taken one by one.
  void explain(const std::vector<hw::FaultEvent>& faults, std::uint64_t packets_dropped) const;
  /// Whether all that was delivered was seen, one by one or in volumes.
  void seen_all(const hw::BoardAccount& account) const;

  std::uint64_t hash() const { return hash_.value(); }

 private:
  void stick(const hw::Stick& stick);
  void run(std::uint64_t first, std::uint64_t count);
  void genuine(std::uint64_t sequence, std::span<const float> samples) const;
  void say(const std::string& line) const {
    if (trace_) trace_(line);
  }

  const Scenario& scenario_;
  const Trace trace_;
  EventHash hash_;
  std::optional<std::uint64_t> next_;           ///< the number that has to come next
  std::optional<std::uint64_t> configured_at_;  ///< … when the first configuration came
  std::vector<hw::Gap> gaps_;
  std::optional<std::uint32_t> last_volume_;
  std::uint64_t seen_ = 0;  ///< sticks
};

}  // namespace wobblebench::bench
