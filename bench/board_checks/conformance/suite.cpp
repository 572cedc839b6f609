#include "bench/board_checks/conformance/suite.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <utility>

#include "base/user_error.h"
#include "bench/pipeline/stick_sources.h"
#include "hw/emulator/fifo_emulator.h"
#include "hw/emulator/xdma_emulator.h"
#include "hw/link/fault_link.h"
#include "hw/link/xdma_link.h"

namespace wobblebench::bench {

namespace {

/// Enough for every check: some take two volumes, none more than 1000 sticks otherwise. A card that
/// stops sending earlier would fail.
constexpr int kLeastVolumes = 4;
constexpr int kLeastSticks = 3000;
/// The driver times out after 10 s; a suite of many openings cannot wait so long.
constexpr double kDriverTimeout_s = 0.2;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "wobblebench-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error(name + ": a folder for the stand-in cannot be made");
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The emulated driver, mounted in a temporary folder.
struct MountedCard {
  TemporaryFolder folder;
  hw::XdmaEmulator card;
  explicit MountedCard(hw::XdmaEmulator::Source source)
      : card(folder.path(), std::move(source), {.timeout_s = kDriverTimeout_s}) {}
};

/// A FIFO is written once: each opening makes its own, which lives as long as the link.
class FifoLink : public hw::Link {
 public:
  explicit FifoLink(std::unique_ptr<hw::Link> source)
      : fifo_(folder_.path(), std::move(source)), link_(fifo_.path()) {}
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    return link_.read(buffer, deadline);
  }
  void cancel() override { link_.cancel(); }
  void resume() override { link_.resume(); }
  void close() override { link_.close(); }
  hw::LinkCapabilities capabilities() const override { return link_.capabilities(); }
  std::string loss() const override { return link_.loss(); }

 private:
  TemporaryFolder folder_;
  hw::FifoEmulator fifo_;
  hw::XdmaLink link_;
};

std::unique_ptr<hw::Link> open_simulated(const MakeSticks& make_sticks) {
  return std::make_unique<sim::SimLink>(make_sticks());
}

MakeSticks simulated(Scene scene) {
  if (!scene.given.contains("acquisition.volumes")) {
    const int enough = kLeastSticks / scene.plan().sticks_per_volume() + 1;
    scene.acquisition.volumes = std::clamp(enough, kLeastVolumes, 1000);
  }
  return simulated_sticks(simulated_scan(scene));
}

ConformanceFixture emulator_fixture(const Scene& scene) {
  if (!hw::XdmaEmulator::can_mount()) {
    throw UserError("--board = xdma=stand-in: needs FUSE: " + hw::XdmaEmulator::mount_error() +
                    "; xdma=fifo-stand-in does without");
  }
  const MakeSticks sticks = simulated(scene);
  const auto mounted = std::make_shared<MountedCard>([sticks] { return open_simulated(sticks); });
  ConformanceFixture fixture;
  fixture.open = [mounted] { return std::make_unique<hw::XdmaLink>(mounted->card.path()); };
  fixture.repeatable = true;
  fixture.unplug = [mounted] { mounted->card.unplug(); };
  fixture.replug = [mounted] { mounted->card.replug(); };
  return fixture;
}

ConformanceFixture fifo_fixture(const Scene& scene) {
  ConformanceFixture fixture;
  fixture.open = [sticks = simulated(scene)] {
    return std::make_unique<FifoLink>(open_simulated(sticks));
  };
  fixture.repeatable = true;
  return fixture;
}

ConformanceFixture bare_fixture(const BoardArguments& board, const Scene& scene) {
  if (board.link.value == "stand-in") return emulator_fixture(scene);
  if (board.link.value == "fifo-stand-in") return fifo_fixture(scene);
  BoardArguments bare = board;
  bare.faults = {};
  const MakeSticks sticks = is_simulated(board) ? simulated(scene) : MakeSticks{};
  ConformanceFixture fixture;
  fixture.open = [bare, sticks] { return open_board_link(bare, sticks); };
  fixture.repeatable = is_simulated(board) || board.link.link == "file";
  return fixture;
}

}  // namespace

ConformanceFixture fixture_of(const BoardArguments& board, const Scene& scene) {
  ConformanceFixture fixture = bare_fixture(board, scene);
  // A board that cannot be opened at all is bad input, not a failed check.
  fixture.open();
  const auto faults = board.link.settings.find("faults");
  return faults == board.link.settings.end() ? fixture : with_faults(fixture, faults->second);
}

ConformanceFixture with_faults(const ConformanceFixture& fixture, const std::string& faults) {
  ConformanceFixture faulty = fixture;
  faulty.faulty = true;
  faulty.open = [open = fixture.open, plan = hw::parse_faults(faults)] {
    return std::make_unique<hw::FaultLink>(open(), plan);
  };
  return faulty;
}

const std::vector<std::string>& each_fault() {
  static const std::vector<std::string> faults = {"drop:0.02",
                                                  "duplicate:0.02",
                                                  "corrupt:0.02",
                                                  "truncate:0.02",
                                                  "reorder:0.02",
                                                  "delay:0.02+delay_ms:2",
                                                  "stall:0.002+stall_ms:50",
                                                  "unplug@150",
                                                  "short_reads:0.2"};
  return faults;
}

const char* to_string(CheckOutcome::Kind kind) {
  switch (kind) {
    case CheckOutcome::Kind::passed:
      return "passed";
    case CheckOutcome::Kind::failed:
      return "failed";
    case CheckOutcome::Kind::skipped:
      return "skipped";
  }
  return "unknown";
}

std::vector<ConformanceCheck> conformance_checks() {
  std::vector<ConformanceCheck> all;
  for (auto part : {state_checks(),
                    slot_checks(),
                    account_checks(),
                    stream_checks(),
                    wait_checks(),
                    link_checks()}) {
    std::move(part.begin(), part.end(), std::back_inserter(all));
  }
  return all;
}

CheckOutcome run_check(const ConformanceCheck& check, const ConformanceFixture& fixture) {
  CheckOutcome outcome{check.name, check.rule, CheckOutcome::Kind::passed, ""};
  try {
    outcome.detail = check.run(fixture);
  } catch (const CheckSkipped& skipped) {
    outcome.kind = CheckOutcome::Kind::skipped;
    outcome.detail = skipped.what();
  } catch (const std::exception& error) {
    outcome.kind = CheckOutcome::Kind::failed;
    outcome.detail = error.what();
  }
  return outcome;
}

std::vector<CheckOutcome> run_conformance(const ConformanceFixture& fixture, const PartDone& done) {
  std::vector<CheckOutcome> outcomes;
  const auto checks = conformance_checks();
  PartCount parts(checks.size(), done);
  for (const auto& check : checks) {
    outcomes.push_back(run_check(check, fixture));
    parts.finish_one();
  }
  return outcomes;
}

int count(const std::vector<CheckOutcome>& outcomes, CheckOutcome::Kind kind) {
  return static_cast<int>(std::count_if(
      outcomes.begin(), outcomes.end(), [&](const auto& outcome) { return outcome.kind == kind; }));
}

}  // namespace wobblebench::bench
