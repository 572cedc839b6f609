#include "hw/emulator/fifo_emulator.h"

#include <gtest/gtest.h>

#include "hw/link/xdma_link.h"
#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"
#include "tests/support/folder_test.h"

namespace wobblebench::hw {
namespace {

class FifoEmulatorTest : public testing_support::FolderTest {
 protected:
  std::unique_ptr<Link> source(ReadStatus ending) const {
    return std::make_unique<MemoryLink>(stream_of(plan_),
                                        MemoryLinkOptions{.chunk_seed = 5, .ending = ending});
  }

  const AcquisitionPlan plan_ = small_plan(5);
};

TEST_F(FifoEmulatorTest, BoardGetsEveryStickAndTheEnd) {
  FifoEmulator emulator(folder_, source(ReadStatus::end_of_stream));
  Board board(std::make_unique<XdmaLink>(emulator.path()));
  board.start();
  Collected seen;
  const Event last = collect(board, seen);
  ASSERT_TRUE(std::holds_alternative<EndOfStream>(last));
  EXPECT_FALSE(std::get<EndOfStream>(last).truncated);
  ASSERT_EQ(seen.sticks.size(), 60U);
  for (const Stick& stick : seen.sticks) EXPECT_TRUE(is_genuine(plan_, stick));
}

TEST_F(FifoEmulatorTest, UnplugEndsTheStream) {
  FifoEmulator emulator(folder_, source(ReadStatus::timeout));
  Board board(std::make_unique<XdmaLink>(emulator.path()));
  board.start();
  Collected seen;
  while (seen.ends.size() < 5) ASSERT_TRUE(note(board.next(patience()), seen));
  emulator.unplug();
  EXPECT_TRUE(std::holds_alternative<EndOfStream>(collect(board, seen)));
}

TEST_F(FifoEmulatorTest, ReaderMayCloseFirst) {
  FifoEmulator emulator(folder_, source(ReadStatus::timeout));
  XdmaLink(emulator.path()).close();
}

TEST_F(FifoEmulatorTest, MayBeDestroyedWithoutAReader) {
  { const FifoEmulator emulator(folder_, source(ReadStatus::timeout)); }
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace wobblebench::hw
