// Moving lanes by flags, against a loop that looks at them one by one.
#include "sim/math/stream_compaction.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

namespace wobblebench::sim {
namespace {

TEST(LanePack, KeepsTheLanesThatAreWithinInOrder) {
  std::mt19937 generator(1);
  const auto lanes = std::make_unique<ScattererLanes>();
  for (int i = 0; i < kLaneCells; ++i) {
    lanes->path_m[i] = static_cast<float>(i);
    lanes->places[i] = static_cast<std::uint32_t>(2 * i);
    lanes->amplitude[i] = static_cast<float>(3 * i);
    lanes->within[i] = static_cast<std::int32_t>(generator() & 1u);
  }
  for (int count = 0; count <= kLaneCells; count += kFlagsTogether) {
    std::vector<float> path_m(kLaneCells + kFlagsTogether), amplitude = path_m;
    std::vector<std::uint32_t> places(path_m.size());
    std::vector<std::uint8_t> which(kLaneCells / 8);
    const int kept =
        pack_lanes(*lanes, count, {path_m.data(), places.data(), amplitude.data()}, which.data());
    int expected = 0;
    for (int i = 0; i < count; ++i) {
      const bool within = lanes->within[i] != 0;
      ASSERT_EQ((which[static_cast<std::size_t>(i / 8)] >> (i % 8) & 1u) != 0, within) << i;
      if (!within) continue;
      const auto at = static_cast<std::size_t>(expected++);
      ASSERT_EQ(path_m[at], static_cast<float>(i));
      ASSERT_EQ(places[at], static_cast<std::uint32_t>(2 * i));
      ASSERT_EQ(amplitude[at], static_cast<float>(3 * i));
    }
    EXPECT_EQ(kept, expected);
  }
}

TEST(LanePack, ListsTheFlagsThatAreSet) {
  std::mt19937 generator(2);
  std::vector<std::uint8_t> flags(kMostCells);
  for (auto& flag : flags) flag = static_cast<std::uint8_t>(generator() & 1u);
  std::vector<std::int32_t> list(kMostCells + kFlagsTogether), expected;
  for (int i = 0; i < kMostCells; ++i) {
    if (flags[static_cast<std::size_t>(i)] != 0) expected.push_back(i);
  }
  const int listed = list_flags(flags.data(), kMostCells, list.data());
  list.resize(static_cast<std::size_t>(listed));
  EXPECT_EQ(list, expected);
}

}  // namespace
}  // namespace wobblebench::sim
