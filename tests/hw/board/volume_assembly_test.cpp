#include "hw/board/volume_assembly.h"

#include <gtest/gtest.h>

#include "tests/hw/support/collect.h"
#include "tests/hw/support/memory_link.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

std::vector<PolarVolume> volumes_of(const Bytes& stream) {
  Board board(std::make_unique<MemoryLink>(stream, MemoryLinkOptions{.chunk_seed = 2}),
              {.ring_slots = 2});
  board.start();
  VolumeAssembly assembly(board);
  std::vector<PolarVolume> volumes;
  while (auto volume = assembly.next(patience())) volumes.push_back(std::move(*volume));
  EXPECT_TRUE(assembly.ended());
  EXPECT_EQ(board.free_slots(), 2) << "no slot is kept";
  return volumes;
}

void expect_holds(const AcquisitionPlan& plan, const PolarVolume& volume, std::uint64_t sequence) {
  const Stick stick = test_stick(plan, sequence);
  const PolarFrame& frame = volume.frame(static_cast<int>(stick.index.frame));
  ASSERT_EQ(frame.arrived[stick.index.line], 1);
  for (std::size_t k = 0; k < 5; ++k) {
    ASSERT_EQ(frame.samples[stick.index.line * 5 + k], stick.samples[k]);
  }
}

TEST(VolumeAssembly, ReturnsEveryVolumeComplete) {
  const AcquisitionPlan plan = small_plan(4);
  const auto volumes = volumes_of(stream_of(plan));
  ASSERT_EQ(volumes.size(), 4U);
  for (std::uint64_t i = 0; i < 48; ++i) expect_holds(plan, volumes[i / 12], i);
  for (std::uint32_t v = 0; v < 4; ++v) EXPECT_EQ(volumes[v].volume_index(), v);
}

TEST(VolumeAssembly, MarksMissingSticksAndZeroesThem) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  packets[packet_index(plan, 14)] = {};
  const auto volumes = volumes_of(join(packets));
  ASSERT_EQ(volumes.size(), 2U);
  EXPECT_EQ(volumes[0].missing_sticks(), 0);
  EXPECT_EQ(volumes[1].missing_sticks(), 1);
  const PolarFrame& frame = volumes[1].frame(0);
  EXPECT_EQ(frame.arrived[2], 0);
  for (std::size_t k = 10; k < 15; ++k) EXPECT_EQ(frame.samples[k], 0);
}

TEST(VolumeAssembly, NeedsNoVolumeEnd) {
  const AcquisitionPlan plan = small_plan(3);
  auto packets = packets_of(plan);
  for (const std::size_t end : {13, 27, 41}) packets[end] = {};
  const auto volumes = volumes_of(join(packets));
  ASSERT_EQ(volumes.size(), 3U);
  for (const PolarVolume& volume : volumes) EXPECT_EQ(volume.missing_sticks(), 0);
}

TEST(VolumeAssembly, ReturnsTheVolumeThatTheEndTruncates) {
  const AcquisitionPlan plan = small_plan(2);
  auto packets = packets_of(plan);
  packets.resize(packet_index(plan, 15) + 1);
  const auto volumes = volumes_of(join(packets));
  ASSERT_EQ(volumes.size(), 2U);
  EXPECT_EQ(volumes[1].missing_sticks(), 8);
  expect_holds(plan, volumes[1], 15);
}

TEST(VolumeAssembly, SkipsAVolumeWithoutSticks) {
  const AcquisitionPlan plan = small_plan(3);
  auto packets = packets_of(plan);
  for (std::uint64_t i = 12; i < 24; ++i) packets[packet_index(plan, i)] = {};
  const auto volumes = volumes_of(join(packets));
  ASSERT_EQ(volumes.size(), 2U);
  EXPECT_EQ(volumes[1].volume_index(), 2U);
}

TEST(VolumeAssembly, KeepsSticksWhenTheDeadlinePasses) {
  const AcquisitionPlan plan = small_plan(1);
  const auto packets = packets_of(plan);
  auto owned = std::make_unique<MemoryLink>(join({packets.begin(), packets.begin() + 6}),
                                            MemoryLinkOptions{.ending = ReadStatus::timeout});
  MemoryLink& line = *owned;
  Board board(std::move(owned));
  board.start();
  VolumeAssembly assembly(board);
  EXPECT_FALSE(assembly.next(HostClock::now() + std::chrono::milliseconds(30)));
  EXPECT_FALSE(assembly.ended());
  line.append(join({packets.begin() + 6, packets.end()}));
  const auto volume = assembly.next(patience());
  ASSERT_TRUE(volume);
  EXPECT_EQ(volume->missing_sticks(), 0);
  ASSERT_TRUE(assembly.configuration());
  EXPECT_TRUE(assembly.configuration()->plan.acquisition() == plan.acquisition());
}

}  // namespace
}  // namespace wobblebench::hw
