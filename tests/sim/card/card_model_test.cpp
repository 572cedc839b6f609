#include "sim/card/card_model.h"

#include <gtest/gtest.h>

#include "base/options.h"

namespace wobblebench::sim {
namespace {

using hw::DeviceDuration;
using hw::DeviceTime;
using Bytes = std::vector<std::byte>;

constexpr DeviceTime kEnd = DeviceTime::max();

DeviceTime at_us(std::int64_t us) {
  return DeviceTime(std::chrono::microseconds(us));
}

Bytes packet(std::size_t size, int value) {
  return Bytes(size, static_cast<std::byte>(value));
}

Bytes read_all(CardModel& card, DeviceTime now) {
  Bytes bytes, piece(7);
  while (const std::size_t count = card.read(piece, now)) {
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + std::ptrdiff_t(count));
  }
  return bytes;
}

TEST(CardModel, BytesArriveCompleteAndInOrder) {
  CardModel card({.buffer_bytes = 100, .buffers = 64});
  Bytes sent;
  for (int i = 0; i < 20; ++i) {
    const Bytes next = packet(64 + 8 * static_cast<std::size_t>(i), i);
    sent.insert(sent.end(), next.begin(), next.end());
    card.push(next, at_us(i), i == 19);
  }
  EXPECT_EQ(read_all(card, kEnd), sent);
  EXPECT_EQ(card.packets_dropped(), 0U);
}

TEST(CardModel, NoByteIsReadableBeforeItsInterrupt) {
  CardModel card({.buffer_bytes = 1000,
                  .buffers = 16,
                  .buffers_per_interrupt = 4,
                  .payload_rate_mb_s = 1,
                  .interrupt_latency_s = 50e-6});
  for (int i = 0; i < 4; ++i) card.push(packet(1000, i), at_us(10000 * i), false);
  // The fourth buffer is full 1 ms (1000 bytes at 1 MB/s) after its packet; then 50 us.
  ASSERT_TRUE(card.next_interrupt());
  EXPECT_EQ(*card.next_interrupt(), at_us(30000 + 1000 + 50));
  Bytes buffer(10000);
  EXPECT_EQ(card.read(buffer, at_us(31049)), 0U);
  EXPECT_EQ(card.read(buffer, at_us(31050)), 4000U);
}

TEST(CardModel, TheEndOfAVolumeFlushes) {
  CardModel card({.buffer_bytes = 1000, .buffers = 16, .buffers_per_interrupt = 8});
  card.push(packet(64, 1), at_us(5), false);
  EXPECT_FALSE(card.next_interrupt());
  card.push(packet(64, 2), at_us(6), true);
  ASSERT_TRUE(card.next_interrupt());
  EXPECT_EQ(read_all(card, kEnd).size(), 128U);
}

TEST(CardModel, TheTransferRateIsLimited) {
  CardModel card({.buffer_bytes = 500, .buffers = 1000, .payload_rate_mb_s = 2});
  // 100 packets at once: 50 kB at 2 MB/s take 25 ms.
  for (int i = 0; i < 100; ++i) card.push(packet(500, i), at_us(0), false);
  EXPECT_EQ(read_all(card, at_us(24999)).size(), 99U * 500);
  EXPECT_EQ(read_all(card, at_us(25000)).size(), 500U);
}

TEST(CardModel, AFullRingDropsWholePacketsUntilTheHostReads) {
  CardModel card({.buffer_bytes = 100, .buffers = 10});
  for (int i = 0; i < 20; ++i) card.push(packet(100, i), at_us(i), false);
  EXPECT_EQ(card.packets_dropped(), 10U);
  const Bytes first = read_all(card, kEnd);
  ASSERT_EQ(first.size(), 1000U);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_EQ(first[i], std::byte(i / 100));
  card.push(packet(100, 77), at_us(30), false);
  EXPECT_EQ(read_all(card, kEnd), packet(100, 77));
  EXPECT_EQ(card.packets_dropped(), 10U);
}

TEST(CardModel, APartlyReadBufferIsNotFree) {
  CardModel card({.buffer_bytes = 100, .buffers = 2});
  card.push(packet(100, 1), at_us(0), false);
  card.push(packet(100, 2), at_us(1), false);
  Bytes buffer(99);
  EXPECT_EQ(card.read(buffer, kEnd), 99U);
  card.push(packet(100, 3), at_us(2), false);
  EXPECT_EQ(card.packets_dropped(), 1U);
  EXPECT_EQ(card.read(std::span(buffer).first(1), kEnd), 1U);
  card.push(packet(100, 4), at_us(3), false);
  EXPECT_EQ(card.packets_dropped(), 1U);
}

TEST(CardModel, RefusesRingsWithoutInterrupts) {
  EXPECT_THROW(CardModel({.buffers = 4, .buffers_per_interrupt = 5}), InvalidOption);
  EXPECT_THROW(CardModel({.buffer_bytes = 8}), InvalidOption);
  EXPECT_NO_THROW(CardModel(CardOptions{}));
}

}  // namespace
}  // namespace wobblebench::sim
