// Moving lanes by flags, against a loop that looks at them one by one.
#include "sim/lane_pack.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <vector>

namespace wobblebench::sim {
namespace {

TEST(LanePack, KeepsTheLanesThatAreWithinInOrder) {
  std::mt19937 generator(1);
  const auto lanes = std::make_unique<CellLanes>();
  for (int i = 0; i < CellLanes::kCount; ++i) {
    lanes->path_m[i] = static_cast<float>(i);
    lanes->entry[i] = 2 * i;
    lanes->amplitude[i] = static_cast<float>(3 * i);
    lanes->within[i] = static_cast<std::int32_t>(generator() & 1u);
  }
  for (const int cells : {0, 1, 7, kLaneCells}) {
    std::vector<float> path_m(CellLanes::kCount + kScatterersInCell), amplitude = path_m;
    std::vector<std::int32_t> entry(path_m.size());
    std::vector<std::uint8_t> which(kLaneCells);
    const int kept =
        pack_lanes(*lanes, cells, {path_m.data(), entry.data(), amplitude.data()}, which.data());
    int expected = 0;
    for (int i = 0; i < cells * kScatterersInCell; ++i) {
      const bool within = lanes->within[i] != 0;
      const unsigned bits = which[static_cast<std::size_t>(i / kScatterersInCell)];
      ASSERT_EQ((bits >> (i % kScatterersInCell) & 1u) != 0, within) << i;
      if (!within) continue;
      const auto at = static_cast<std::size_t>(expected++);
      ASSERT_EQ(path_m[at], static_cast<float>(i));
      ASSERT_EQ(entry[at], 2 * i);
      ASSERT_EQ(amplitude[at], static_cast<float>(3 * i));
    }
    EXPECT_EQ(kept, expected);
  }
}

TEST(LanePack, KeepsTheCellsWhoseFlagsAreSet) {
  std::mt19937 generator(2);
  const auto cells = std::make_unique<TestedCells>();
  for (int i = 0; i < TestedCells::kCount; ++i) {
    cells->axial[i] = static_cast<float>(i);
    cells->lateral[i] = static_cast<float>(2 * i);
    cells->elevation[i] = static_cast<float>(3 * i);
    cells->key[i] = static_cast<std::uint32_t>(4 * i);
    cells->row[i] = 5 * i;
    cells->near[i] = i < kMostCells ? static_cast<std::uint8_t>(generator() & 1u) : 0;
  }
  std::vector<float> axial(TestedCells::kCount), lateral = axial, elevation = axial;
  std::vector<std::uint32_t> key(axial.size());
  std::vector<std::int32_t> row(axial.size()), list(axial.size());
  const TouchedHashCells to{
      axial.data(), lateral.data(), elevation.data(), nullptr, key.data(), row.data()};
  const int kept = pack_cells(*cells, cells->near, kMostCells, to);
  ASSERT_EQ(list_flags(cells->near, kMostCells, list.data()), kept);
  std::size_t at = 0;
  for (int i = 0; i < kMostCells; ++i) {
    if (cells->near[i] == 0) continue;
    ASSERT_EQ(list[at], i);
    ASSERT_EQ(axial[at], cells->axial[i]);
    ASSERT_EQ(lateral[at], cells->lateral[i]);
    ASSERT_EQ(elevation[at], cells->elevation[i]);
    ASSERT_EQ(key[at], cells->key[i]);
    ASSERT_EQ(row[at], cells->row[i]);
    ++at;
  }
  EXPECT_EQ(kept, static_cast<int>(at));
}

}  // namespace
}  // namespace wobblebench::sim
