// A damaged stream loses the damaged packets only, and no damaged packet is accepted.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "tests/hw/support/streams.h"

namespace wobblebench::hw {
namespace {

/// Sequence numbers of all decoded sticks, each of which must equal the original.
std::set<std::uint64_t> genuine_sticks(const AcquisitionPlan& plan, const Bytes& stream) {
  Decoder decoder;
  decoder.feed(stream);
  decoder.finish();
  std::set<std::uint64_t> sequences;
  while (const auto packet = decoder.next()) {
    const auto* stick = std::get_if<StickPacket>(&*packet);
    if (stick == nullptr) continue;
    EXPECT_TRUE(is_genuine(plan, stick->stick)) << stick->stick.sequence;
    EXPECT_TRUE(sequences.insert(stick->stick.sequence).second);
  }
  EXPECT_EQ(decoder.pending_bytes(), 0U);
  return sequences;
}

TEST(WireDamage, EveryTruncationKeepsAllCompleteSticks) {
  const AcquisitionPlan plan = small_plan();
  const Bytes stream = stream_of(plan);
  const auto owner = owners(plan);
  for (std::size_t length = 0; length <= stream.size(); ++length) {
    std::set<std::uint64_t> whole;
    for (std::size_t i = 0; i < length; ++i) {
      const bool ends = i + 1 == stream.size() || owner[i + 1] != owner[i];
      if (ends && owner[i] >= 0) whole.insert(static_cast<std::uint64_t>(owner[i]));
    }
    ASSERT_EQ(genuine_sticks(plan, Bytes(stream.begin(), stream.begin() + std::ptrdiff_t(length))),
              whole);
  }
}

TEST(WireDamage, EveryMissingByteLosesOnlyItsStick) {
  const AcquisitionPlan plan = small_plan();
  const Bytes stream = stream_of(plan);
  const auto owner = owners(plan);
  for (std::size_t hole = 0; hole < stream.size(); ++hole) {
    Bytes damaged = stream;
    damaged.erase(damaged.begin() + std::ptrdiff_t(hole));
    const auto sticks = genuine_sticks(plan, damaged);
    ASSERT_EQ(sticks.size(), owner[hole] < 0 ? 24U : 23U);
    ASSERT_EQ(sticks.count(static_cast<std::uint64_t>(owner[hole])), 0U);
  }
}

TEST(WireDamage, EveryFlippedBitLosesOnlyItsStick) {
  const AcquisitionPlan plan = small_plan();
  const Bytes stream = stream_of(plan);
  const auto owner = owners(plan);
  for (std::size_t bit = 0; bit < 8 * stream.size(); ++bit) {
    Bytes damaged = stream;
    damaged[bit / 8] ^= std::byte(1U << (bit % 8));
    const auto sticks = genuine_sticks(plan, damaged);
    ASSERT_EQ(sticks.size(), owner[bit / 8] < 0 ? 24U : 23U) << bit;
    ASSERT_EQ(sticks.count(static_cast<std::uint64_t>(owner[bit / 8])), 0U) << bit;
  }
}

TEST(WireDamage, RandomDamageLosesOnlyTouchedSticks) {
  const AcquisitionPlan plan = small_plan();
  const Bytes stream = stream_of(plan);
  const auto owner = owners(plan);
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    Bytes damaged = stream;
    std::set<std::int64_t> touched;
    const std::uint64_t hits = 1 + hash(seed, 0) % 12;
    for (std::uint64_t hit = 1; hit <= hits; ++hit) {
      const std::size_t at = hash(seed, 3 * hit) % stream.size();
      const std::size_t length = 1 + hash(seed, 3 * hit + 1) % 40;
      for (std::size_t i = at; i < std::min(at + length, stream.size()); ++i) {
        damaged[i] = static_cast<std::byte>(hash(seed + i, hit));
        if (owner[i] >= 0) touched.insert(owner[i]);
      }
    }
    const auto sticks = genuine_sticks(plan, damaged);
    ASSERT_GE(sticks.size() + touched.size(), 24U) << "seed " << seed;
    for (std::int64_t i = 0; i < 24; ++i) {
      ASSERT_TRUE(touched.count(i) == 1 || sticks.count(static_cast<std::uint64_t>(i)) == 1)
          << "seed " << seed << " stick " << i;
    }
  }
}

TEST(WireDamage, NoiseIsNeverAStick) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Bytes noise;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      // With many magics.
      const std::uint64_t draw = hash(seed, i);
      if (draw % 8 == 0) noise.insert(noise.end(), kWireMagic.begin(), kWireMagic.end());
      noise.push_back(static_cast<std::byte>(draw >> 8 & (draw % 3 == 0 ? 0xFF : 0x03)));
    }
    EXPECT_TRUE(genuine_sticks(small_plan(), noise).empty());
  }
}

}  // namespace
}  // namespace wobblebench::hw
