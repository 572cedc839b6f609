// The emulated driver, read by the link and by raw system calls.
#include "hw/emulator/xdma_emulator.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/ioctl.h>

#include <atomic>
#include <thread>

#include "base/file.h"
#include "base/options.h"
#include "hw/link/xdma_link.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

/// Far below the driver's timeout of 10 s, in which a wrong close() would block.
constexpr auto kAtOnce = std::chrono::seconds(1);

class XdmaEmulatorTest : public testing_support::FolderTest {
 protected:
  void SetUp() override {
    if (!XdmaEmulator::can_mount()) GTEST_SKIP() << XdmaEmulator::mount_error();
  }
  ~XdmaEmulatorTest() override { emulator_.reset(); }

  /// A card that sends the plan, then nothing.
  void plug_in(const XdmaEmulatorOptions& options = {}, std::uint64_t chunk_seed = 0) {
    const MemoryLinkOptions source = {.chunk_seed = chunk_seed, .ending = ReadStatus::timeout};
    emulator_ = std::make_unique<XdmaEmulator>(
        folder_,
        [source, bytes = stream_of(plan_)] { return std::make_unique<MemoryLink>(bytes, source); },
        options);
  }

  std::unique_ptr<XdmaLink> link(const XdmaLinkOptions& options = {}) const {
    return std::make_unique<XdmaLink>(emulator_->path(), options);
  }

  FileDescriptor open_raw(int flags) const {
    return FileDescriptor(::open(emulator_->path().c_str(), O_RDONLY | O_CLOEXEC | flags));
  }

  /// Takes events up to the end of the plan's last volume, or the end of the stream.
  Event take_all(Board& board, Collected& seen) const {
    for (;;) {
      Event event = board.next(patience());
      if (!note(event, seen)) return event;
      if (seen.ends.size() == static_cast<std::size_t>(plan_.acquisition().volumes)) return event;
    }
  }

  void expect_all_sticks(std::unique_ptr<Link> from) const {
    Board board(std::move(from));
    board.start();
    Collected seen;
    take_all(board, seen);
    ASSERT_EQ(seen.sticks.size(), 60U);
    for (const Stick& stick : seen.sticks) EXPECT_TRUE(is_genuine(plan_, stick));
    EXPECT_TRUE(seen.gaps.empty());
    EXPECT_EQ(board.damage().regions, 0U);
  }

  const AcquisitionPlan plan_ = small_plan(5);
  const std::vector<Bytes> packets_ = packets_of(plan_);
  std::unique_ptr<XdmaEmulator> emulator_;
};

Bytes read_raw(const FileDescriptor& from, std::size_t length, int* error = nullptr) {
  Bytes bytes(length);
  const ssize_t count = ::read(from.get(), bytes.data(), length);
  if (error != nullptr) *error = count < 0 ? errno : 0;
  bytes.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  return bytes;
}

int error_of_read(const FileDescriptor& from, std::size_t length) {
  int error = 0;
  read_raw(from, length, &error);
  return error;
}

TEST_F(XdmaEmulatorTest, BoardGetsEveryStick) {
  plug_in();
  auto card = link();
  EXPECT_EQ(card->capabilities().origin, StreamOrigin::emulator);
  EXPECT_FALSE(card->capabilities().waits_for_reader);
  expect_all_sticks(std::move(card));
}

TEST_F(XdmaEmulatorTest, BoardGetsEveryStickInTransfersAcrossPackets) {
  plug_in({.timeout_s = 0.02}, 3);
  expect_all_sticks(link({.transfer_kb = 1, .end_of_packet = false}));
}

TEST_F(XdmaEmulatorTest, BoardGetsEveryStickInShortReads) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    plug_in({.short_reads = true, .seed = seed}, seed);
    expect_all_sticks(link());
    emulator_.reset();
  }
}

TEST_F(XdmaEmulatorTest, TransferEndsWithAPacketAfterOTrunc) {
  plug_in();
  const FileDescriptor raw = open_raw(O_TRUNC);
  for (const Bytes& packet : packets_) EXPECT_TRUE(read_raw(raw, 65536) == packet);
}

TEST_F(XdmaEmulatorTest, TransferIsFilledWithoutOTrunc) {
  plug_in();
  const Bytes stream = stream_of(plan_);
  const FileDescriptor raw = open_raw(0);
  EXPECT_TRUE(read_raw(raw, 1000) == Bytes(stream.begin(), stream.begin() + 1000));
  EXPECT_TRUE(read_raw(raw, 1000) == Bytes(stream.begin() + 1000, stream.begin() + 2000));
}

TEST_F(XdmaEmulatorTest, SecondOpenerIsBusyUntilTheFirstCloses) {
  plug_in();
  FileDescriptor raw = open_raw(0);
  ASSERT_TRUE(raw.is_open());
  EXPECT_FALSE(open_raw(0).is_open());
  EXPECT_EQ(errno, EBUSY);
  try {
    link({.busy_patience_s = 0.03});
    ADD_FAILURE() << "was opened twice";
  } catch (const LinkOpenError& error) {
    EXPECT_EQ(error.fault(), OpenFault::busy);
    EXPECT_EQ(
        error.what(),
        emulator_->path().string() + ": Device or resource busy (EBUSY); has one reader at a time");
  }
  std::jthread closer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    raw.close();
  });
  expect_all_sticks(link({.busy_patience_s = 60}));
  closer.join();
}

TEST_F(XdmaEmulatorTest, MisalignedLengthIsInvalidAndIoctlGivesTheAlignment) {
  plug_in({.alignment_bytes = 4096});
  FileDescriptor raw = open_raw(O_TRUNC);
  EXPECT_EQ(error_of_read(raw, 1000), EINVAL);
  int alignment = 0;
  EXPECT_EQ(::ioctl(raw.get(), _IOR('q', 6, int), &alignment), 0);
  EXPECT_EQ(alignment, 4096);
  EXPECT_EQ(::ioctl(raw.get(), _IOR('q', 5, int), &alignment), -1);
  EXPECT_TRUE(read_raw(raw, 4096) == packets_[0]);
  raw.close();
  EXPECT_THROW(link({.transfer_kb = 2}), InvalidOption);
  expect_all_sticks(link({.transfer_kb = 4}));
}

TEST_F(XdmaEmulatorTest, StalledReadTimesOutWithoutLoss) {
  plug_in({.timeout_s = 0.02, .stall_at_packet = 3});
  {
    const FileDescriptor raw = open_raw(O_TRUNC);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(error_of_read(raw, 4096), 0);
    EXPECT_EQ(error_of_read(raw, 4096), ETIMEDOUT);
    emulator_->stall(false);
    EXPECT_TRUE(read_raw(raw, 4096) == packets_[3]);
  }
  auto stalled = link();
  Bytes buffer(4096);
  std::size_t sent = packets_[0].size() + packets_[1].size() + packets_[2].size();
  while (sent > 0) sent -= stalled->read(buffer, patience()).bytes;
  const HostTime deadline = HostClock::now() + std::chrono::milliseconds(100);
  EXPECT_EQ(stalled->read(buffer, deadline).status, ReadStatus::timeout);
  emulator_->stall(false);
  EXPECT_EQ(stalled->read(buffer, patience()).status, ReadStatus::ok);
}

TEST_F(XdmaEmulatorTest, PartialTransferIsReturnedAfterTheTimeout) {
  plug_in({.timeout_s = 0.02, .stall_at_packet = 1});
  EXPECT_TRUE(read_raw(open_raw(0), 65536) == packets_[0]);
}

TEST_F(XdmaEmulatorTest, UnplugDuringAWaitLosesTheDevice) {
  plug_in({.stall_at_packet = 8});
  Board board(link());
  board.start();
  Collected seen;
  while (seen.sticks.size() < 7) note(board.next(patience()), seen);
  std::jthread unplugger([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    emulator_->unplug();
  });
  const Event last = board.next(patience());
  unplugger.join();
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(last));
  EXPECT_EQ(std::get<DeviceLost>(last).cause, DeviceLossCause::unplugged);
  EXPECT_EQ(std::get<DeviceLost>(last).reason,
            emulator_->path().string() + ": No such device (ENODEV)");
  EXPECT_EQ(board.state(), BoardState::lost);
}

TEST_F(XdmaEmulatorTest, ReplugAllowsReopening) {
  plug_in();
  const FileDescriptor before = open_raw(O_TRUNC);
  EXPECT_EQ(error_of_read(before, 4096), 0);
  emulator_->unplug();
  try {
    link();
    ADD_FAILURE() << "was opened while unplugged";
  } catch (const LinkOpenError& error) {
    EXPECT_EQ(error.fault(), OpenFault::missing);
  }
  emulator_->replug();
  expect_all_sticks(link());
  EXPECT_EQ(error_of_read(before, 4096), ENODEV);
}

TEST_F(XdmaEmulatorTest, UnplugAtAPacketDeliversAllBeforeIt) {
  plug_in({.unplug_at_packet = 20});
  Board board(link());
  board.start();
  Collected seen;
  ASSERT_TRUE(std::holds_alternative<DeviceLost>(collect(board, seen)));
  // 14 packets a volume: a configuration, 12 sticks, an end.
  EXPECT_EQ(seen.sticks.size(), 12U + 5U);
  EXPECT_TRUE(board.account().balanced());
}

TEST_F(XdmaEmulatorTest, AllOnesIsALoss) {
  for (const bool end_of_packet : {true, false}) {
    plug_in({.all_ones_at_packet = 20});
    Board board(link({.end_of_packet = end_of_packet}));
    board.start();
    Collected seen;
    const Event last = collect(board, seen);
    ASSERT_TRUE(std::holds_alternative<DeviceLost>(last));
    EXPECT_EQ(std::get<DeviceLost>(last).reason,
              emulator_->path().string() + ": reads all ones: the card has left the bus");
    EXPECT_EQ(seen.sticks.size(), 12U + 5U);
    EXPECT_EQ(board.damage().bytes_skipped, 0U);
    emulator_.reset();
  }
}

TEST_F(XdmaEmulatorTest, CloseDuringAReadReturnsAtOnceAndAllowsReopening) {
  plug_in({.timeout_s = 3});
  emulator_->stall(true);
  auto first = link();
  Bytes buffer(100);
  const HostTime deadline = HostClock::now() + std::chrono::milliseconds(50);
  EXPECT_EQ(first->read(buffer, deadline).status, ReadStatus::timeout);
  const HostTime begin = HostClock::now();
  first->close();
  EXPECT_LT(HostClock::now() - begin, kAtOnce);
  EXPECT_EQ(first->read(buffer, patience()).status, ReadStatus::lost);
  // The first one's thread gives the node back when its read returns.
  emulator_->stall(false);
  expect_all_sticks(link({.busy_patience_s = 60}));
}

TEST_F(XdmaEmulatorTest, DestroyedDuringAReadItUnmounts) {
  plug_in({.stall_at_packet = 2});
  const FileDescriptor idle = open_raw(O_TRUNC);
  int error = 0;
  std::jthread reader([&] {
    while (error == 0) error = error_of_read(idle, 4096);
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const HostTime begin = HostClock::now();
  emulator_.reset();
  reader.join();
  EXPECT_LT(HostClock::now() - begin, kAtOnce);
  // The kernel's own answer if it was between two reads.
  EXPECT_TRUE(error == ENODEV || error == ENOTCONN || error == ECONNABORTED) << error;
  EXPECT_NE(error_of_read(idle, 4096), 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(XdmaEmulatorTest, SignalInterruptsAReader) {
  plug_in({.stall_at_packet = 0});
  const FileDescriptor raw = open_raw(0);
  struct sigaction quiet {};
  quiet.sa_handler = [](int) {};
  struct sigaction before {};
  sigaction(SIGUSR1, &quiet, &before);
  int error = 0;
  std::atomic<bool> done = false;
  std::jthread reader([&] {
    error = error_of_read(raw, 4096);
    done = true;
  });
  // The first signals may come before it reads.
  while (!done) {
    pthread_kill(reader.native_handle(), SIGUSR1);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  reader.join();
  sigaction(SIGUSR1, &before, nullptr);
  EXPECT_EQ(error, EINTR);
}

TEST(XdmaEmulatorOptions, AreChecked) {
  EXPECT_NO_THROW(check_options(XdmaEmulatorOptions{}));
  EXPECT_THROW(XdmaEmulator("/nowhere", nullptr, {.alignment_bytes = 3}), InvalidOption);
  EXPECT_THROW(XdmaEmulator("/nowhere", nullptr, {.timeout_s = 0}), InvalidOption);
  EXPECT_THROW(XdmaEmulator("/nowhere", nullptr), std::runtime_error);
}

}  // namespace
}  // namespace wobblebench::hw
