// Stream compaction against a loop over single elements.
#include "sim/speckle/scatterers/stream_compaction.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

#include "sim/speckle/scatterers/scatterer_cells.h"

namespace wobblebench::sim {
namespace {

TEST(StreamCompaction, KeepsTheSelectedLanesInOrder) {
  std::mt19937 generator(1);
  const auto lanes = std::make_unique<ScattererLanes>();
  for (int i = 0; i < kCellsPerBatch; ++i) {
    lanes->range_m[i] = static_cast<float>(i);
    lanes->table_index[i] = static_cast<std::uint32_t>(2 * i);
    lanes->amplitude[i] = static_cast<float>(3 * i);
    lanes->selected[i] = static_cast<std::int32_t>(generator() & 1u);
  }
  for (int count = 0; count <= kCellsPerBatch; count += kCompactionWidth) {
    std::vector<float> range_m(kCellsPerBatch + kCompactionWidth), amplitude = range_m;
    std::vector<std::uint32_t> table_index(range_m.size());
    std::vector<std::uint8_t> mask(kCellsPerBatch / 8);
    const int kept = compact_scatterers(
        *lanes, count, {range_m.data(), table_index.data(), amplitude.data()}, mask.data());
    int expected = 0;
    for (int i = 0; i < count; ++i) {
      const bool selected = lanes->selected[i] != 0;
      ASSERT_EQ((mask[static_cast<std::size_t>(i / 8)] >> (i % 8) & 1u) != 0, selected) << i;
      if (!selected) continue;
      const auto at = static_cast<std::size_t>(expected++);
      ASSERT_EQ(range_m[at], static_cast<float>(i));
      ASSERT_EQ(table_index[at], static_cast<std::uint32_t>(2 * i));
      ASSERT_EQ(amplitude[at], static_cast<float>(3 * i));
    }
    EXPECT_EQ(kept, expected);
  }
}

TEST(StreamCompaction, ListsTheFlagsThatAreSet) {
  std::mt19937 generator(2);
  std::vector<std::uint8_t> flags(kMaxCells);
  for (auto& flag : flags) flag = static_cast<std::uint8_t>(generator() & 1u);
  std::vector<std::int32_t> list(kMaxCells + kCompactionWidth), expected;
  for (int i = 0; i < kMaxCells; ++i) {
    if (flags[static_cast<std::size_t>(i)] != 0) expected.push_back(i);
  }
  const int listed = list_set_flags(flags.data(), kMaxCells, list.data());
  list.resize(static_cast<std::size_t>(listed));
  EXPECT_EQ(list, expected);
}

}  // namespace
}  // namespace wobblebench::sim
