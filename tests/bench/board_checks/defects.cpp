#include "tests/bench/board_checks/defects.h"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <memory>
#include <thread>
#include <utility>

#include "bench/pipeline/board_link.h"
#include "bench/pipeline/stick_sources.h"

namespace wobblebench::bench {

ConformanceFixture correct_fixture(const std::string& arguments) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 5;
  acquisition.sticks_per_frame = 40;
  acquisition.samples_per_stick = 32;
  acquisition.volumes = 50;
  const hw::AcquisitionPlan plan({}, acquisition);
  ConformanceFixture fixture;
  fixture.open = [board = parse_board("sim" + arguments), plan] {
    return open_board_link(board, [&] { return synthetic_sticks(plan, 1); });
  };
  fixture.repeatable = true;
  fixture.faulty = arguments.find("faults=") != std::string::npos;
  return fixture;
}

std::vector<Defect> seeded_defects() {
  auto all = board_defects();
  auto links = link_defects();
  std::move(links.begin(), links.end(), std::back_inserter(all));
  return all;
}

std::vector<DefectOutcome> check_defects() {
  const auto checks = conformance_checks();
  std::vector<DefectOutcome> outcomes;
  for (Defect& defect : seeded_defects()) {
    const auto check = std::find_if(
        checks.begin(), checks.end(), [&](const auto& one) { return one.name == defect.check; });
    if (check == checks.end()) throw std::logic_error("no check is named " + defect.check);
    CheckOutcome outcome = run_check(*check, defect.fixture);
    outcomes.push_back({std::move(defect), std::move(outcome)});
  }
  return outcomes;
}

namespace {

using std::chrono::milliseconds;

/// Forwards every call; a defect overrides one.
class ForwardingLink : public hw::Link {
 public:
  explicit ForwardingLink(std::unique_ptr<hw::Link> inner) : inner_(std::move(inner)) {}
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    return inner_->read(buffer, deadline);
  }
  void cancel() override { inner_->cancel(); }
  void resume() override { inner_->resume(); }
  void close() override { inner_->close(); }
  hw::LinkCapabilities capabilities() const override { return inner_->capabilities(); }
  std::string loss() const override { return inner_->loss(); }

 private:
  std::unique_ptr<hw::Link> inner_;
};

class OkWithoutBytes : public ForwardingLink {
 public:
  using ForwardingLink::ForwardingLink;
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    if (++reads_ % 5 == 0) return {0, hw::ReadStatus::ok};
    return ForwardingLink::read(buffer, deadline);
  }

 private:
  int reads_ = 0;
};

class PollsSlowly : public ForwardingLink {
 public:
  using ForwardingLink::ForwardingLink;
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    std::this_thread::sleep_for(milliseconds(60));
    return ForwardingLink::read(buffer, deadline);
  }
};

/// Only the first read after cancel() returns cancelled.
class CancelWearsOff : public ForwardingLink {
 public:
  using ForwardingLink::ForwardingLink;
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    const hw::ReadResult result = ForwardingLink::read(buffer, deadline);
    if (result.status == hw::ReadStatus::cancelled) ForwardingLink::resume();
    return result;
  }
};

class OpenAfterClose : public ForwardingLink {
 public:
  using ForwardingLink::ForwardingLink;
  void close() override {}
};

class CapabilitiesContradict : public ForwardingLink {
 public:
  using ForwardingLink::ForwardingLink;
  hw::LinkCapabilities capabilities() const override {
    hw::LinkCapabilities said = ForwardingLink::capabilities();
    said.buffers_per_interrupt = said.buffers + 1;
    return said;
  }
};

/// Reports the end of the stream when the card is pulled out.
class SilentWhenUnplugged : public ForwardingLink {
 public:
  SilentWhenUnplugged(std::unique_ptr<hw::Link> inner, std::shared_ptr<std::atomic<bool>> unplugged)
      : ForwardingLink(std::move(inner)), unplugged_(std::move(unplugged)) {}
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    if (*unplugged_) return {0, hw::ReadStatus::end_of_stream};
    return ForwardingLink::read(buffer, deadline);
  }

 private:
  std::shared_ptr<std::atomic<bool>> unplugged_;
};

template <class DefectiveLink>
Defect make_defect(const std::string& check, const std::string& what) {
  Defect defect{check, what, correct_fixture()};
  defect.fixture.open = [open = defect.fixture.open] {
    return std::make_unique<DefectiveLink>(open());
  };
  return defect;
}

/// Faults are injected, and the fixture does not say so.
Defect hidden_faults() {
  Defect defect{"stream.undamaged", "packets come twice", correct_fixture(",faults=duplicate:0.1")};
  defect.fixture.faulty = false;
  return defect;
}

Defect busy_after_close() {
  Defect defect{"link.reopen",
                "the device stays busy after close() until somebody has asked for it in vain",
                correct_fixture()};
  auto busy = std::make_shared<bool>(false);
  defect.fixture.open = [open = defect.fixture.open, busy] {
    if (*busy) {
      *busy = false;
      throw hw::LinkOpenError(hw::OpenFault::busy, "card: is busy; must be free");
    }
    *busy = true;
    return open();
  };
  return defect;
}

Defect silent_when_unplugged() {
  Defect defect{
      "unplug.card", "a card pulled out looks like the end of the stream", correct_fixture()};
  auto unplugged = std::make_shared<std::atomic<bool>>(false);
  defect.fixture.unplug = [unplugged] { *unplugged = true; };
  defect.fixture.replug = [unplugged] { *unplugged = false; };
  defect.fixture.open = [open = defect.fixture.open, unplugged] {
    return std::make_unique<SilentWhenUnplugged>(open(), unplugged);
  };
  return defect;
}

}  // namespace

std::vector<Defect> link_defects() {
  return {
      hidden_faults(),
      silent_when_unplugged(),
      make_defect<OkWithoutBytes>("link.read", "a read is ok and gives no byte"),
      make_defect<PollsSlowly>("link.poll", "a poll sleeps for 60 ms"),
      make_defect<CancelWearsOff>("link.cancel", "cancel() wears off by itself"),
      make_defect<OpenAfterClose>("link.close", "a closed link goes on sending"),
      busy_after_close(),
      make_defect<CapabilitiesContradict>("link.capabilities",
                                          "more buffers an interrupt than buffers"),
  };
}

}  // namespace wobblebench::bench
