#include "hw/link/device_gone.h"

#include <gtest/gtest.h>

#include <vector>

namespace wobblebench::hw {
namespace {

using Bytes = std::vector<std::byte>;

Bytes ones(std::size_t count) {
  return Bytes(count, std::byte{0xFF});
}

/// Other bytes, then ones.
Bytes other_then_ones(std::size_t others, std::size_t count) {
  Bytes bytes(others, std::byte{7});
  bytes.insert(bytes.end(), count, std::byte{0xFF});
  return bytes;
}

TEST(AllOnes, PassesOtherBytesOnAtOnce) {
  DeviceGoneDetector watch;
  const auto verdict = watch.look_at(other_then_ones(100, 20));
  EXPECT_EQ(verdict.held_back, 0U);
  EXPECT_EQ(verdict.sound, 120U);
  EXPECT_FALSE(verdict.gone);
}

TEST(AllOnes, HoldsATransferOfOnesBackUntilItShowsToBeSamples) {
  DeviceGoneDetector watch;
  EXPECT_EQ(watch.look_at(ones(1024)).sound, 0U);
  EXPECT_EQ(watch.look_at(ones(1024)).sound, 0U);
  const auto verdict = watch.look_at(other_then_ones(1, 0));
  EXPECT_EQ(verdict.held_back, 2048U);
  EXPECT_EQ(verdict.sound, 1U);
  EXPECT_EQ(watch.end(), 0U);
}

TEST(AllOnes, TheLongestSoundRunIsSoundAndOneMoreIsNot) {
  DeviceGoneDetector sound, gone;
  sound.look_at(other_then_ones(1, 64));
  gone.look_at(other_then_ones(1, 64));
  EXPECT_FALSE(sound.look_at(ones(kLongestValidOnes - 64)).gone);
  EXPECT_EQ(sound.end(), kLongestValidOnes - 64);
  const auto verdict = gone.look_at(ones(kLongestValidOnes - 63));
  EXPECT_TRUE(verdict.gone);
  EXPECT_EQ(verdict.sound + verdict.held_back, 0U);
}

TEST(AllOnes, OfATransferThatTurnsToOnesTheFirstPartIsHandedOn) {
  DeviceGoneDetector watch;
  const auto verdict = watch.look_at(other_then_ones(300, kLongestValidOnes + 1));
  EXPECT_TRUE(verdict.gone);
  EXPECT_EQ(verdict.sound, 300U);
}

}  // namespace
}  // namespace wobblebench::hw
