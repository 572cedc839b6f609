// The link on FIFOs, files and the kernel's own devices. Tests of the driver's rules are in
// emulator/xdma_emulator_test.cpp.
#include "hw/link/xdma_link.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <fstream>
#include <thread>

#include "base/file.h"
#include "base/options.h"
#include "hw/link/xdma_reader.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

constexpr HostTime kNow = HostTime::min();
/// Far below the driver's timeout of 10 s, in which a wrong close() would block.
constexpr auto kAtOnce = std::chrono::seconds(1);

class XdmaLinkOnFifo : public testing_support::FolderTest {
 protected:
  XdmaLinkOnFifo() { EXPECT_EQ(::mkfifo(path_.c_str(), 0600), 0); }

  FileDescriptor writer() const {
    return FileDescriptor(::open(path_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
  }

  const std::filesystem::path path_ = file("stream");
};

class XdmaLinkPaths : public testing_support::FolderTest {};

void write_all(const FileDescriptor& to, const Bytes& bytes) {
  ASSERT_EQ(::write(to.get(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
}

Bytes read_until(Link& link, ReadStatus last) {
  Bytes all, buffer(1000);
  for (;;) {
    const ReadResult result = link.read(buffer, patience());
    all.insert(all.end(), buffer.begin(), buffer.begin() + static_cast<long>(result.bytes));
    if (result.status == ReadStatus::ok) continue;
    EXPECT_EQ(result.status, last);
    return all;
  }
}

OpenFault fault_of(const std::filesystem::path& path, std::string& what) {
  try {
    const XdmaLink link(path, {.busy_patience_s = 0});
  } catch (const LinkOpenError& error) {
    what = error.what();
    return error.fault();
  }
  ADD_FAILURE() << path << " was opened";
  return OpenFault::empty;
}

/// The driver's libxdma.c answers a time-out with ETIMEDOUT, and before June 2026 with ERESTARTSYS,
/// 512 (include/linux/errno.h).
TEST(XdmaErrors, ATimeOutIsNoLossWhateverTheDriversVersion) {
  for (const int error : {EINTR, ETIMEDOUT, 512}) EXPECT_TRUE(is_to_be_repeated(error)) << error;
  for (const int error : {EIO, ENODEV, EINVAL, EFAULT, ENOMEM, 511, 515}) {
    EXPECT_FALSE(is_to_be_repeated(error)) << error;
  }
}

TEST_F(XdmaLinkOnFifo, BoardGetsEveryStickAndTheEnd) {
  const AcquisitionPlan plan = small_plan(5);
  Board board(std::make_unique<XdmaLink>(path_));
  board.start();
  std::jthread feeder([&, to = writer()] {
    for (const Bytes& packet : packets_of(plan)) {
      const auto cut = static_cast<long>(packet.size() / 3);
      write_all(to, {packet.begin(), packet.begin() + cut});
      write_all(to, {packet.begin() + cut, packet.end()});
    }
  });
  Collected seen;
  const Event last = collect(board, seen);
  feeder.join();
  ASSERT_TRUE(std::holds_alternative<EndOfStream>(last));
  EXPECT_FALSE(std::get<EndOfStream>(last).truncated);
  ASSERT_EQ(seen.sticks.size(), 60U);
  for (const Stick& stick : seen.sticks) EXPECT_TRUE(is_genuine(plan, stick));
  EXPECT_TRUE(seen.gaps.empty());
}

TEST_F(XdmaLinkOnFifo, NoDataIsNoEndBeforeOrAfterTheFirstWriter) {
  XdmaLink link(path_);
  Bytes buffer(100);
  EXPECT_EQ(link.read(buffer, kNow).status, ReadStatus::timeout);
  HostTime deadline = HostClock::now() + std::chrono::milliseconds(20);
  EXPECT_EQ(link.read(buffer, deadline).status, ReadStatus::timeout);
  EXPECT_GE(HostClock::now(), deadline);
  FileDescriptor to = writer();
  deadline = HostClock::now() + std::chrono::milliseconds(20);
  EXPECT_EQ(link.read(buffer, deadline).status, ReadStatus::timeout);
  write_all(to, Bytes(3, std::byte{5}));
  EXPECT_EQ(link.read(buffer, patience()).bytes, 3U);
  to.close();
  EXPECT_EQ(link.read(buffer, patience()).status, ReadStatus::end_of_stream);
  EXPECT_EQ(link.read(buffer, patience()).status, ReadStatus::end_of_stream);
}

TEST_F(XdmaLinkOnFifo, WaitsForASlowReader) {
  Bytes sent(10U << 20U);
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] = std::byte(hash(1, i));
  XdmaLink link(path_);
  FileDescriptor to = writer();
  ::fcntl(to.get(), F_SETFL, 0);
  std::jthread feeder([&] {
    write_all(to, sent);
    to.close();
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(read_until(link, ReadStatus::end_of_stream) == sent);
  feeder.join();
}

TEST_F(XdmaLinkOnFifo, CancelWakesReaderAndLosesNothing) {
  XdmaLink link(path_);
  const FileDescriptor to = writer();
  Bytes buffer(100);
  std::jthread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    link.cancel();
  });
  EXPECT_EQ(link.read(buffer, patience()).status, ReadStatus::cancelled);
  canceller.join();
  write_all(to, Bytes(7, std::byte{1}));
  EXPECT_EQ(link.read(buffer, patience()).status, ReadStatus::cancelled);
  link.resume();
  EXPECT_EQ(link.read(buffer, patience()).bytes, 7U);
}

TEST_F(XdmaLinkOnFifo, CloseReturnsAtOnceAndIsFinal) {
  XdmaLink link(path_);
  const FileDescriptor to = writer();
  const HostTime begin = HostClock::now();
  link.close();
  link.close();
  EXPECT_LT(HostClock::now() - begin, kAtOnce);
  Bytes buffer(100);
  EXPECT_EQ(link.read(buffer, patience()).status, ReadStatus::lost);
  EXPECT_EQ(link.loss(), path_.string() + ": closed");
  EXPECT_TRUE(XdmaLink(path_).capabilities().waits_for_reader);
}

TEST_F(XdmaLinkOnFifo, AllOnesIsALossWithoutData) {
  XdmaLink link(path_, {.transfer_kb = 4});
  FileDescriptor to = writer();
  ::fcntl(to.get(), F_SETFL, 0);
  write_all(to, Bytes(100, std::byte{3}));
  Bytes buffer(200);
  EXPECT_EQ(link.read(buffer, patience()).bytes, 100U);
  write_all(to, Bytes(kLongestValidOnes + 1, std::byte{0xFF}));
  EXPECT_TRUE(read_until(link, ReadStatus::lost).empty());
  EXPECT_EQ(link.loss(), path_.string() + ": reads all ones: the card has left the bus");
}

TEST_F(XdmaLinkOnFifo, OnesThatMayBeSamplesAreDelivered) {
  Bytes sent(kLongestValidOnes, std::byte{0xFF});
  sent.push_back(std::byte{1});
  sent.insert(sent.end(), 5000, std::byte{0xFF});
  XdmaLink link(path_, {.transfer_kb = 1});
  FileDescriptor to = writer();
  ::fcntl(to.get(), F_SETFL, 0);
  write_all(to, sent);
  to.close();
  EXPECT_TRUE(read_until(link, ReadStatus::end_of_stream) == sent);
}

TEST_F(XdmaLinkOnFifo, ReportsCapabilities) {
  const LinkCapabilities capabilities = XdmaLink(path_, {.transfer_kb = 128}).capabilities();
  EXPECT_EQ(capabilities.origin, StreamOrigin::emulator);
  EXPECT_TRUE(capabilities.copy_in);
  EXPECT_EQ(capabilities.buffer_bytes, 131072U);
  EXPECT_EQ(capabilities.buffers, 32);
  EXPECT_EQ(capabilities.buffers_per_interrupt, 1);
}

TEST_F(XdmaLinkPaths, RejectsOtherKindsOfFilesInOneLine) {
  const std::string allowed =
      "; must be a character device or a FIFO; a recording is opened with file=";
  std::string what;
  EXPECT_EQ(fault_of(folder_, what), OpenFault::wrong_kind);
  EXPECT_EQ(what, folder_.string() + ": is a folder" + allowed);
  EXPECT_EQ(fault_of(file("none"), what), OpenFault::missing);
  EXPECT_EQ(what, file("none").string() + ": No such file or directory (ENOENT)" + allowed);
  EXPECT_EQ(fault_of("", what), OpenFault::missing);
  std::ofstream(file("plain")) << "text";
  EXPECT_EQ(fault_of(file("plain") / "below", what), OpenFault::missing);
  sockaddr_un address{.sun_family = AF_UNIX};
  file("socket").string().copy(address.sun_path, sizeof address.sun_path - 1);
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  ASSERT_EQ(::bind(socket.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(fault_of(file("socket"), what), OpenFault::wrong_kind);
  EXPECT_EQ(what, file("socket").string() + ": is a socket" + allowed);
}

TEST_F(XdmaLinkPaths, RejectsARecordingWithoutTruncatingIt) {
  std::ofstream(file("recording")) << "a whole volume";
  std::string what;
  EXPECT_EQ(fault_of(file("recording"), what), OpenFault::wrong_kind);
  EXPECT_TRUE(holds(what, ": is a regular file; "));
  EXPECT_EQ(std::filesystem::file_size(file("recording")), 14U);
}

TEST_F(XdmaLinkPaths, RejectsAnUnreadableFifo) {
  if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
  ASSERT_EQ(::mkfifo(file("locked").c_str(), 0000), 0);
  std::string what;
  EXPECT_EQ(fault_of(file("locked"), what), OpenFault::not_permitted);
  EXPECT_EQ(
      what,
      file("locked").string() + ": Permission denied (EACCES); must be readable by this user");
}

TEST(XdmaLinkOnDevice, DeviceWithoutDataTimesOut) {
  const HostTime begin = HostClock::now();
  {
    XdmaLink link("/dev/null");
    Bytes buffer(100);
    const HostTime deadline = HostClock::now() + std::chrono::milliseconds(20);
    EXPECT_EQ(link.read(buffer, deadline).status, ReadStatus::timeout);
    EXPECT_EQ(link.capabilities().origin, StreamOrigin::hardware);
    EXPECT_FALSE(link.capabilities().waits_for_reader);
  }
  EXPECT_LT(HostClock::now() - begin, kAtOnce);
}

TEST(XdmaLinkOnDevice, EndlessDeviceIsReadAndClosed) {
  XdmaLink link("/dev/zero");
  Bytes buffer(100, std::byte{1});
  EXPECT_EQ(link.read(buffer, patience()).bytes, 100U);
  EXPECT_TRUE(buffer == Bytes(100));
}

TEST(XdmaLinkOptions, AreChecked) {
  EXPECT_NO_THROW(check_options(XdmaLinkOptions{}));
  EXPECT_THROW(XdmaLink("/dev/null", {.transfer_kb = 0}), InvalidOption);
  EXPECT_THROW(XdmaLink("/dev/null", {.busy_patience_s = 61}), InvalidOption);
  EXPECT_EQ(refusal_of<InvalidOption>([] { const XdmaLink link("/dev/null", {.transfer_kb = 6}); }),
            "transfer_kb = 6: must be a multiple of the device's alignment, 4096 bytes");
}

}  // namespace
}  // namespace wobblebench::hw
