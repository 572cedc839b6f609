#include "hw/link/xdma_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace wobblebench::hw {
namespace {

using Bytes = std::vector<std::byte>;

Bytes ones(std::size_t count) {
  return Bytes(count, std::byte{0xFF});
}

/// Other bytes, then ones.
Bytes other_then_ones(std::size_t others, std::size_t count) {
  Bytes bytes = ones(others + count);
  std::fill_n(bytes.begin(), others, std::byte{7});
  return bytes;
}

TEST(DeviceGoneDetector, PassesOtherBytesAtOnce) {
  DeviceGoneDetector detector;
  const auto result = detector.inspect(other_then_ones(100, 20));
  EXPECT_EQ(result.held_back, 0U);
  EXPECT_EQ(result.valid, 120U);
  EXPECT_FALSE(result.gone);
}

TEST(DeviceGoneDetector, HoldsTransfersOfOnesBackUntilOtherBytesFollow) {
  DeviceGoneDetector detector;
  EXPECT_EQ(detector.inspect(ones(1024)).valid, 0U);
  EXPECT_EQ(detector.inspect(ones(1024)).valid, 0U);
  const auto result = detector.inspect(other_then_ones(1, 0));
  EXPECT_EQ(result.held_back, 2048U);
  EXPECT_EQ(result.valid, 1U);
  EXPECT_EQ(detector.end(), 0U);
}

TEST(DeviceGoneDetector, LongestValidRunIsValidAndOneMoreIsNot) {
  DeviceGoneDetector present, gone;
  EXPECT_FALSE(present.inspect(other_then_ones(1, 64)).gone);
  EXPECT_FALSE(gone.inspect(other_then_ones(1, 64)).gone);
  EXPECT_FALSE(present.inspect(ones(kLongestValidOnes - 64)).gone);
  EXPECT_EQ(present.end(), kLongestValidOnes - 64);
  const auto result = gone.inspect(ones(kLongestValidOnes - 63));
  EXPECT_TRUE(result.gone);
  EXPECT_EQ(result.valid + result.held_back, 0U);
}

TEST(DeviceGoneDetector, PassesThePartOfATransferBeforeTheOnes) {
  DeviceGoneDetector detector;
  const auto result = detector.inspect(other_then_ones(300, kLongestValidOnes + 1));
  EXPECT_TRUE(result.gone);
  EXPECT_EQ(result.valid, 300U);
}

}  // namespace
}  // namespace wobblebench::hw
