#include <atomic>
#include <memory>
#include <thread>
#include <utility>

#include "bench/checks/conformance/broken.h"

namespace wobblebench::bench {

namespace {

using std::chrono::milliseconds;

/// A link whose every function is the inner one's, for breakages to change one.
class PassingLink : public hw::Link {
 public:
  explicit PassingLink(std::unique_ptr<hw::Link> inner) : inner_(std::move(inner)) {}
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

class OkWithoutBytes : public PassingLink {
 public:
  using PassingLink::PassingLink;
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    if (++reads_ % 5 == 0) return {0, hw::ReadStatus::ok};
    return PassingLink::read(buffer, deadline);
  }

 private:
  int reads_ = 0;
};

class PollsSlowly : public PassingLink {
 public:
  using PassingLink::PassingLink;
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    std::this_thread::sleep_for(milliseconds(60));
    return PassingLink::read(buffer, deadline);
  }
};

/// The first read after cancel() says so; then it is forgotten.
class CancelWearsOff : public PassingLink {
 public:
  using PassingLink::PassingLink;
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    const hw::ReadResult result = PassingLink::read(buffer, deadline);
    if (result.status == hw::ReadStatus::cancelled) PassingLink::resume();
    return result;
  }
};

class OpenAfterClose : public PassingLink {
 public:
  using PassingLink::PassingLink;
  void close() override {}
};

class CapabilitiesContradict : public PassingLink {
 public:
  using PassingLink::PassingLink;
  hw::LinkCapabilities capabilities() const override {
    hw::LinkCapabilities said = PassingLink::capabilities();
    said.buffers_per_interrupt = said.buffers + 1;
    return said;
  }
};

/// Goes silent when the card is pulled out, instead of saying so.
class SilentWhenUnplugged : public PassingLink {
 public:
  SilentWhenUnplugged(std::unique_ptr<hw::Link> inner, std::shared_ptr<std::atomic<bool>> unplugged)
      : PassingLink(std::move(inner)), unplugged_(std::move(unplugged)) {}
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override {
    if (*unplugged_) return {0, hw::ReadStatus::end_of_stream};
    return PassingLink::read(buffer, deadline);
  }

 private:
  std::shared_ptr<std::atomic<bool>> unplugged_;
};

template <class BrokenLink>
Breakage broken(const std::string& check, const std::string& what) {
  Breakage breakage{check, what, sound_fixture()};
  breakage.fixture.open = [open = breakage.fixture.open] {
    return std::make_unique<BrokenLink>(open());
  };
  return breakage;
}

/// Faults strike, and the link does not say that they do.
Breakage hidden_faults() {
  Breakage breakage{
      "stream.undamaged", "packets come twice", sound_fixture(",faults=duplicate:0.1")};
  breakage.fixture.faulty = false;
  return breakage;
}

Breakage busy_after_close() {
  Breakage breakage{
      "link.reopen", "the device stays busy for a second after close()", sound_fixture()};
  auto until = std::make_shared<hw::HostTime>(hw::HostTime::min());
  breakage.fixture.open = [open = breakage.fixture.open, until] {
    if (hw::HostClock::now() < *until) {
      throw hw::LinkOpenError(hw::OpenFault::busy, "card: is busy; must be free");
    }
    *until = hw::HostClock::now() + std::chrono::seconds(1);
    return open();
  };
  return breakage;
}

Breakage silent_when_unplugged() {
  Breakage breakage{
      "unplug.card", "a card pulled out looks like the end of the stream", sound_fixture()};
  auto unplugged = std::make_shared<std::atomic<bool>>(false);
  breakage.fixture.unplug = [unplugged] { *unplugged = true; };
  breakage.fixture.replug = [unplugged] { *unplugged = false; };
  breakage.fixture.open = [open = breakage.fixture.open, unplugged] {
    return std::make_unique<SilentWhenUnplugged>(open(), unplugged);
  };
  return breakage;
}

}  // namespace

std::vector<Breakage> broken_links() {
  return {
      hidden_faults(),
      silent_when_unplugged(),
      broken<OkWithoutBytes>("link.read", "a read is ok and gives no byte"),
      broken<PollsSlowly>("link.poll", "a poll sleeps for 60 ms"),
      broken<CancelWearsOff>("link.cancel", "cancel() wears off by itself"),
      broken<OpenAfterClose>("link.close", "a closed link goes on sending"),
      busy_after_close(),
      broken<CapabilitiesContradict>("link.capabilities", "more buffers an interrupt than buffers"),
  };
}

}  // namespace wobblebench::bench
