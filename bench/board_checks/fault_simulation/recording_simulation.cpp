#include "bench/board_checks/fault_simulation/recording_simulation.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include "base/file.h"
#include "bench/board_checks/fault_simulation/recording_oracle.h"
#include "bench/board_checks/fault_simulation/virtual_time.h"
#include "bench/pipeline/synthetic_sticks.h"
#include "hw/link/fault_link.h"
#include "hw/wire/crc32c.h"

namespace wobblebench::bench {

namespace {

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

RecordingSimulationResult simulate_recording(const Scenario& scenario, const Oracle::Trace& trace) {
  return RecordingSimulation(scenario, trace).run();
}

}  // namespace wobblebench::bench
