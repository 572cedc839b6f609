#include "sim/tissue/tissue_map.h"

#include <gtest/gtest.h>

#include "base/byte_stream.h"
#include "phantoms/phantom.h"
#include "sim/probe_simulator.h"

namespace wobblebench::sim {
namespace {

class TissueMapBytesTest : public testing::Test {
 protected:
  std::shared_ptr<const TissueMap> read(std::string_view bytes) const {
    return tissue_map_from_bytes(bytes, phantom_.surfaces().size(), phantom_.materials().size());
  }

  const phantoms::Phantom phantom_ =
      phantoms::make_phantom({.name = "sphere", .voxel_m = 2e-3, .radius_m = 6e-3});
  const TissueMap map_{phantom_, 1e-3, 0};
  const std::string bytes_ = to_bytes(map_);
};

TEST_F(TissueMapBytesTest, HoldTheWholeMap) {
  const auto same = read(bytes_);
  EXPECT_EQ(to_bytes(*same), bytes_);
  EXPECT_EQ(same->bytes(), map_.bytes());
  EXPECT_EQ(same->cells(), map_.cells());
  for (double x = -12e-3; x < 12e-3; x += 0.37e-3) {
    const glm::dvec3 at(x, 0.4 * x, 0.3e-3);
    EXPECT_EQ(same->material(at), map_.material(at));
    EXPECT_EQ(same->normal(0, at), map_.normal(0, at));
  }
}

TEST_F(TissueMapBytesTest, AProbeScansItAlike) {
  const auto placed = phantoms::still_at(phantom_, phantom_.suggested_position_m());
  const hw::AcquisitionPlan plan({}, {.sticks_per_frame = 8, .frames_per_volume = 3});
  int asked = 0;
  const TissueMapSource maps = [&](const phantoms::Phantom& phantom, double reach_m, int threads) {
    ++asked;
    return read(to_bytes(TissueMap(phantom, reach_m, threads)));
  };
  const ProbeSimulator made(placed, plan, {}), given(placed, plan, {}, maps);
  EXPECT_EQ(given.volume(0), made.volume(0));
  EXPECT_EQ(asked, 1);
}

TEST_F(TissueMapBytesTest, AreRefusedWhereTheyEndTooSoonOrLate) {
  for (std::size_t size = 0; size < bytes_.size(); size += 1 + size / 50) {
    EXPECT_THROW(read(bytes_.substr(0, size)), DamagedBytes) << size;
  }
  EXPECT_THROW(read(bytes_ + "x"), DamagedBytes);
}

TEST_F(TissueMapBytesTest, OfFewerSurfacesOrMaterialsAreRefused) {
  EXPECT_THROW(tissue_map_from_bytes(bytes_, 0, phantom_.materials().size()), DamagedBytes);
  EXPECT_THROW(tissue_map_from_bytes(bytes_, 1, 1), DamagedBytes);
}

TEST_F(TissueMapBytesTest, WithAFlippedBitAreRefusedOrStayWithinTheMap) {
  // Header, cells and entries; the nodes behind them may hold any number.
  const std::size_t structure = bytes_.size() - map_.bytes() / 2;
  for (std::size_t bit = 0; bit < 8 * structure; bit += 1 + bit / 200) {
    std::string damaged = bytes_;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    try {
      const auto map = read(damaged);
      for (double x = -12e-3; x < 12e-3; x += 2.1e-3) {
        EXPECT_LT(map->material({x, x, 0}), int(phantom_.materials().size()));
      }
    } catch (const DamagedBytes&) {
    }
  }
}

}  // namespace
}  // namespace wobblebench::sim
