#include "bench/board_checks/fault_simulation/recording_simulation.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "base/file.h"
#include "bench/board_checks/fault_simulation/oracle.h"
#include "bench/board_checks/fault_simulation/scenario.h"
#include "bench/pipeline/stick_sources.h"
#include "hw/link/fault_link.h"
#include "hw/wire/crc32c.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kSequenceOffset = 16;  // as in docs/wire_format.md

hw::Stick sent_stick(const Scenario& scenario, std::uint64_t sequence) {
  const hw::AcquisitionPlan& plan = scenario.plan;
  hw::Stick stick;
  hw::schedule(stick, plan, sequence);
  const auto samples = static_cast<std::uint32_t>(plan.acquisition().samples_per_stick);
  for (std::uint32_t k = 0; k < samples; ++k) {
    stick.samples.push_back(synthetic_sample(scenario.seed, sequence, k));
  }
  return stick;
}

void expect(bool holds, const std::string& rule) {
  if (!holds) throw RuleViolation("recording: " + rule);
}

void require_equal(std::uint64_t actual, std::uint64_t expected, const std::string& what) {
  expect(actual == expected,
         std::to_string(actual) + " " + what + ", and there are " + std::to_string(expected));
}

bool has_damage(const std::vector<FoundPacket>& packets, std::size_t bytes) {
  std::size_t end = 0;
  for (const FoundPacket& packet : packets) {
    if (packet.begin != end) return true;
    end = packet.end;
  }
  return end != bytes;
}

std::uint64_t count(const std::vector<FoundPacket>& packets, hw::PacketKind kind) {
  return static_cast<std::uint64_t>(
      std::count_if(packets.begin(), packets.end(), [&](const auto& p) { return p.kind == kind; }));
}

using Bytes = std::vector<std::byte>;

/// Thrown inside the recorder, which nothing of it survives.
struct Killed {};

/// A file in memory, with a path.
class MemoryFile {
 public:
  explicit MemoryFile(const Bytes& bytes) : file_(::memfd_create("recording", MFD_CLOEXEC)) {
    const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
    if (count == static_cast<ssize_t>(bytes.size())) return;
    throw std::system_error(errno, std::generic_category(), "a file in memory");
  }
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_.get()); }

 private:
  FileDescriptor file_;
};

/// Reads another link in reads of any length, lets virtual time pass where there is nothing to
/// read, keeps what was read, and kills the recorder at some read.
class TappedLink : public hw::Link {
 public:
  TappedLink(hw::Link& inner, VirtualTime& time, Draws& draws, std::optional<int> kill_at)
      : inner_(inner), time_(time), draws_(draws), reads_left_(kill_at) {}

  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime) override {
    if (reads_left_ && (*reads_left_)-- == 0) throw Killed{};
    const std::size_t most =
        draws_.chance(0.5) ? buffer.size() : static_cast<std::size_t>(draws_.between(1, 3000));
    for (;;) {
      const hw::ReadResult result = inner_.read(buffer.first(most), hw::HostTime::min());
      received_.insert(received_.end(),
                       buffer.begin(),
                       buffer.begin() + static_cast<std::ptrdiff_t>(result.bytes));
      if (result.status != hw::ReadStatus::timeout || draws_.chance(0.1)) return result;
      time_.advance(std::chrono::microseconds(draws_.between(0, 4000)));
    }
  }
  void cancel() override { inner_.cancel(); }
  void resume() override { inner_.resume(); }
  void close() override { inner_.close(); }
  hw::LinkCapabilities capabilities() const override { return inner_.capabilities(); }

  const Bytes& received() const { return received_; }

 private:
  hw::Link& inner_;
  VirtualTime& time_;
  Draws& draws_;
  std::optional<int> reads_left_;
  Bytes received_;
};

std::optional<hw::RecordingContents> inspect(const Bytes& bytes) {
  try {
    return hw::inspect_recording(MemoryFile(bytes).path());
  } catch (const hw::LinkOpenError&) {
    return {};
  }
}

/// Empty where there is no configuration.
Bytes salvage(const Bytes& bytes, const std::optional<hw::RecordingContents>& contents) {
  Bytes salvaged;
  if (!contents || contents->configurations == 0) return salvaged;
  hw::salvage_recording(MemoryFile(bytes).path(), [&](auto part) {
    salvaged.insert(salvaged.end(), part.begin(), part.end());
  });
  return salvaged;
}

class RecordingSimulation {
 public:
  RecordingSimulation(const Scenario& scenario, const Oracle::Trace& trace)
      : scenario_(scenario), trace_(trace), oracle_(scenario), draws_(scenario.seed ^ kPurpose) {}

  RecordingSimulationResult run() {
    RecordingSimulationResult result;
    EventHash hash;
    try {
      Bytes recorded = record();
      result.bytes_recorded = recorded.size();
      if (draws_.chance(0.7)) recorded.resize(draws_.next() % (recorded.size() + 1));
      if (trace_) trace_("recording of " + std::to_string(recorded.size()) + " bytes");
      const auto contents = inspect(recorded);
      oracle_.check_inspection(recorded, contents);
      const Bytes salvaged = salvage(recorded, contents);
      const auto of_salvaged = inspect(salvaged);
      result.sticks_salvaged =
          oracle_.check_salvage(recorded, salvaged, of_salvaged, salvage(salvaged, of_salvaged));
      hash.add(recorded.size());
      hash.add(hw::crc32c(recorded));
      hash.add(hw::crc32c(salvaged));
    } catch (const RuleViolation& broken) {
      result.failure = broken.what();
    } catch (const std::exception& error) {
      result.failure = "recording: " + std::string(error.what());
    }
    result.hash = hash.value();
    return result;
  }

 private:
  static constexpr std::uint64_t kPurpose = 0x5245434F52440000;

  Bytes record() {
    VirtualTime time;
    hw::FaultLink link(
        std::make_unique<sim::SimLink>(synthetic_sticks(scenario_.plan, scenario_.seed),
                                       scenario_.link,
                                       std::make_shared<sim::SimLinkStatistics>(),
                                       &time),
        scenario_.faults,
        &time);
    const int all = scenario_.plan.acquisition().volumes;
    const int volumes = draws_.chance(0.3) ? draws_.between(1, all) : 0;
    std::optional<int> kill_at;
    if (draws_.chance(0.5)) kill_at = draws_.between(0, 40);
    TappedLink tapped(link, time, draws_, kill_at);
    Bytes kept;
    hw::Recorder recorder(tapped,
                          [&](auto bytes) { kept.insert(kept.end(), bytes.begin(), bytes.end()); },
                          {.volumes = volumes});
    bool killed = false;
    try {
      static_cast<void>(recorder.run([] { return false; }));
      if (volumes == 0) {
        oracle_.check_account(tapped.received(), recorder.progress());
      }
    } catch (const Killed&) {
      killed = true;
    }
    oracle_.check_kept(tapped.received(), kept, killed, volumes);
    return kept;
  }

  const Scenario& scenario_;
  const Oracle::Trace& trace_;
  const RecordingOracle oracle_;
  Draws draws_;
};

}  // namespace

RecordingOracle::RecordingOracle(const Scenario& scenario) {
  const hw::AcquisitionPlan& plan = scenario.plan;
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  for (std::uint32_t volume = 0; volume < static_cast<std::uint32_t>(plan.acquisition().volumes);
       ++volume) {
    const std::uint64_t first = volume * sticks, next = first + sticks;
    const hw::ConfigurationPacket configuration{.sequence = first,
                                                .volume = volume,
                                                .time = plan.stick_time(first),
                                                .source = hw::StreamOrigin::simulated,
                                                .probe = plan.probe(),
                                                .acquisition = plan.acquisition()};
    encode(configuration, sent_.emplace_back(Sent{hw::PacketKind::configuration, first, {}}).bytes);
    for (std::uint64_t sequence = first; sequence < next; ++sequence) {
      encode(sent_stick(scenario, sequence),
             sent_.emplace_back(Sent{hw::PacketKind::stick, sequence, {}}).bytes);
    }
    encode(hw::VolumeEndPacket{next, volume, plan.volume_end_time(volume)},
           sent_.emplace_back(Sent{hw::PacketKind::volume_end, next, {}}).bytes);
  }
}

std::vector<FoundPacket> RecordingOracle::find(Bytes bytes) const {
  std::vector<FoundPacket> found;
  const auto begins = [&](std::size_t at, const Sent& sent) {
    return sent.bytes.size() <= bytes.size() - at &&
           std::equal(sent.bytes.begin(), sent.bytes.end(), bytes.begin() + std::ptrdiff_t(at));
  };
  for (std::size_t at = 0; at + hw::kWireHeaderBytes <= bytes.size(); ++at) {
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    if (!std::equal(hw::kWireMagic.begin(), hw::kWireMagic.end(), from)) continue;
    // Numbers are far below 2^16. Packets of one number lie next to each other in time.
    const auto low = std::to_integer<std::uint64_t>(bytes[at + kSequenceOffset]);
    const auto high = std::to_integer<std::uint64_t>(bytes[at + kSequenceOffset + 1]);
    const auto first = std::lower_bound(
        sent_.begin(), sent_.end(), high << 8U | low, [](const Sent& sent, std::uint64_t number) {
          return sent.sequence < number;
        });
    for (auto sent = first; sent != sent_.end() && sent->sequence == first->sequence; ++sent) {
      if (!begins(at, *sent)) continue;
      found.push_back({sent->kind, sent->sequence, at, at + sent->bytes.size()});
      at += sent->bytes.size() - 1;
      break;
    }
  }
  return found;
}

std::vector<std::uint64_t> RecordingOracle::in_order(Bytes bytes, bool from_configuration) const {
  std::vector<std::uint64_t> sticks;
  std::optional<std::uint64_t> next;
  bool configured = false;
  for (const FoundPacket& packet : find(bytes)) {
    configured = configured || packet.kind == hw::PacketKind::configuration;
    const bool stick = packet.kind == hw::PacketKind::stick;
    // A salvage begins with the first packet that has a stick, or says which one comes.
    if (!next && !from_configuration && packet.kind == hw::PacketKind::volume_end) continue;
    const bool in_time = !next || packet.sequence >= *next;
    if (!in_time) continue;
    next = packet.sequence + (stick ? 1 : 0);
    if (stick && (configured || !from_configuration)) sticks.push_back(packet.sequence);
  }
  return sticks;
}

void RecordingOracle::check_kept(Bytes received, Bytes kept, bool killed, int volumes) const {
  expect(kept.size() <= received.size() && std::equal(kept.begin(), kept.end(), received.begin()),
         "the sink got other bytes than the link sent");
  const auto packets = find(kept);
  if (volumes > 0 &&
      count(packets, hw::PacketKind::volume_end) >= static_cast<std::uint64_t>(volumes)) {
    const bool ends =
        packets.back().kind == hw::PacketKind::volume_end && packets.back().end == kept.size();
    if (ends || has_damage(packets, kept.size())) return;
  }
  if (!killed) require_equal(kept.size(), received.size(), "bytes kept");
  require_equal(packets.size(), find(received).size(), "whole packets kept");
}

void RecordingOracle::check_account(Bytes received, const hw::RecordingProgress& progress) const {
  expect(progress.account.balanced(), "its account is not balanced");
  require_equal(progress.account.delivered, in_order(received, true).size(), "sticks delivered");
}

void RecordingOracle::check_inspection(Bytes recorded,
                                       const std::optional<hw::RecordingContents>& contents) const {
  const auto packets = find(recorded);
  if (!contents) {
    require_equal(0, packets.size(), "packets in what is refused");
    return;
  }
  expect(contents->account.balanced(), "the inspection's account is not balanced");
  require_equal(contents->configurations,
                count(packets, hw::PacketKind::configuration),
                "configurations inspected");
  require_equal(contents->sticks, count(packets, hw::PacketKind::stick), "sticks inspected");
  require_equal(
      contents->volume_ends, count(packets, hw::PacketKind::volume_end), "volume ends inspected");
  require_equal(
      contents->account.delivered, in_order(recorded, true).size(), "sticks of the account");
}

std::uint64_t RecordingOracle::check_salvage(Bytes recorded,
                                             Bytes salvaged,
                                             const std::optional<hw::RecordingContents>& contents,
                                             Bytes again) const {
  const auto packets = find(recorded);
  if (count(packets, hw::PacketKind::configuration) == 0) {
    require_equal(salvaged.size(), 0, "bytes salvaged without a configuration");
    return 0;
  }
  const auto expected = in_order(recorded, false);
  std::vector<std::uint64_t> sticks;
  for (const FoundPacket& packet : find(salvaged)) {
    if (packet.kind == hw::PacketKind::stick) sticks.push_back(packet.sequence);
  }
  require_equal(sticks.size(), expected.size(), "sticks salvaged");
  expect(sticks == expected, "other sticks are salvaged than were recorded");
  expect(contents.has_value() && !contents->damaged(), "what is salvaged is damaged");
  const hw::BoardAccount& account = contents->account;
  require_equal(account.delivered, expected.size(), "sticks of the salvage's account");
  require_equal(account.lost.total(), account.lost.link, "sticks lost in the salvage, by the link");
  require_equal(account.duplicates, 0, "sticks salvaged twice");
  expect(std::equal(salvaged.begin(), salvaged.end(), again.begin(), again.end()),
         "the salvage of a salvage is another");
  return sticks.size();
}

RecordingSimulationResult simulate_recording(const Scenario& scenario, const Oracle::Trace& trace) {
  return RecordingSimulation(scenario, trace).run();
}

}  // namespace wobblebench::bench
