#include "phantoms/io/phantom_bytes.h"

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include "base/byte_stream.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/label_finder.h"

namespace wobblebench::phantoms {
namespace {

void expect_same_grid(const FloatGrid& a, const FloatGrid& b) {
  EXPECT_EQ(a.getName(), b.getName());
  EXPECT_EQ(a.transform(), b.transform());
  EXPECT_EQ(a.background(), b.background());
  EXPECT_EQ(a.memUsage(), b.memUsage());
  EXPECT_TRUE(a.tree().hasSameTopology(b.tree()));
  auto value = b.cbeginValueAll();
  int different = 0;
  for (auto expected = a.cbeginValueAll(); expected; ++expected, ++value) {
    ASSERT_TRUE(value);
    different += *value != *expected || value.isValueOn() != expected.isValueOn() ||
                 value.getBoundingBox() != expected.getBoundingBox();
  }
  EXPECT_EQ(different, 0);
  EXPECT_FALSE(value);
}

class PhantomBytes : public testing::TestWithParam<std::string> {};

TEST_P(PhantomBytes, HoldEveryVoxelAndAllElse) {
  const Phantom made = make_phantom({.name = GetParam(), .voxel_m = 1e-3});
  const auto bytes = to_bytes(made);
  ASSERT_TRUE(bytes);
  const Phantom read = phantom_from_bytes(*bytes);
  EXPECT_EQ(read.name(), made.name());
  EXPECT_EQ(read.background(), made.background());
  EXPECT_EQ(read.region_of_interest().low, made.region_of_interest().low);
  EXPECT_EQ(read.region_of_interest().high, made.region_of_interest().high);
  EXPECT_EQ(read.suggested_position_m(), made.suggested_position_m());
  EXPECT_EQ(read.scatterers(), made.scatterers());
  ASSERT_EQ(read.joint().has_value(), made.joint().has_value());
  if (made.joint()) {
    EXPECT_EQ(read.joint()->center_m, made.joint()->center_m);
    EXPECT_EQ(read.joint()->inner_m, made.joint()->inner_m);
    EXPECT_EQ(read.joint()->outer_m, made.joint()->outer_m);
  }
  EXPECT_EQ(made.parts() != nullptr, GetParam() == "fetal_face");
  ASSERT_EQ(read.parts() != nullptr, made.parts() != nullptr);
  const LabelFinder finder(made), again(read);
  for (int x = -30; x < 30; x += 2) {
    for (int y = -30; y < 30; y += 2) {
      for (int z = -20; z < 20; z += 2) {
        const glm::dvec3 at = 1e-3 * glm::dvec3(x, y, z);
        ASSERT_EQ(again.at(at), finder.at(at));
      }
    }
  }
  ASSERT_EQ(read.landmarks().size(), made.landmarks().size());
  for (std::size_t i = 0; i < made.landmarks().size(); ++i) {
    EXPECT_EQ(read.landmarks()[i].name, made.landmarks()[i].name);
    EXPECT_EQ(read.landmarks()[i].position_m, made.landmarks()[i].position_m);
  }
  ASSERT_EQ(read.measures().size(), made.measures().size());
  EXPECT_EQ(made.measures().empty(), GetParam() != "fetal_face");
  for (std::size_t i = 0; i < made.measures().size(); ++i) {
    EXPECT_EQ(read.measures()[i].name, made.measures()[i].name);
    EXPECT_EQ(read.measures()[i].value, made.measures()[i].value);
    EXPECT_EQ(read.measures()[i].target, made.measures()[i].target);
  }
  ASSERT_EQ(read.materials().size(), made.materials().size());
  for (std::size_t i = 0; i < made.materials().size(); ++i) {
    const Material &a = made.materials()[i], &b = read.materials()[i];
    EXPECT_EQ(std::tie(a.name, a.source), std::tie(b.name, b.source));
    EXPECT_EQ(std::tie(a.sound_speed_m_s, a.impedance_rayl, a.attenuation_db_per_cm_mhz),
              std::tie(b.sound_speed_m_s, b.impedance_rayl, b.attenuation_db_per_cm_mhz));
    EXPECT_EQ(std::tie(a.backscatter_db, a.roughness), std::tie(b.backscatter_db, b.roughness));
  }
  ASSERT_EQ(read.surfaces().size(), made.surfaces().size());
  for (std::size_t i = 0; i < made.surfaces().size(); ++i) {
    const Surface &a = made.surfaces()[i], &b = read.surfaces()[i];
    EXPECT_EQ(std::tie(a.name, a.inside, a.is_target), std::tie(b.name, b.inside, b.is_target));
    expect_same_grid(*made.grids().signed_distance[i], *read.grids().signed_distance[i]);
  }
}

TEST(PhantomBytesOfAMouth, HoldIt) {
  const Phantom made = make_phantom({.voxel_m = 1.5e-3, .mouth_open_m = 6e-3});
  const Phantom read = phantom_from_bytes(to_bytes(made).value());
  ASSERT_TRUE(read.joint()->mouth);
  const Mouth &a = *made.joint()->mouth, &b = *read.joint()->mouth;
  EXPECT_EQ(a.axes, b.axes);
  EXPECT_EQ(std::tie(a.center_m, a.opening_m, a.reach_m),
            std::tie(b.center_m, b.opening_m, b.reach_m));
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, PhantomBytes, testing::ValuesIn(phantom_names()));

Phantom ball() {
  return make_phantom({.name = "sphere", .voxel_m = 2e-3, .radius_m = 6e-3});
}

TEST(DamagedPhantomBytes, AreRefusedWhereTheyEndTooSoonOrLate) {
  const std::string bytes = to_bytes(ball()).value();
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 50) {
    EXPECT_THROW(static_cast<void>(phantom_from_bytes(bytes.substr(0, size))), DamagedBytes)
        << size;
  }
  EXPECT_THROW(static_cast<void>(phantom_from_bytes(bytes + "x")), DamagedBytes);
}

TEST(DamagedPhantomBytes, AreRefusedOrMakeAnotherPhantom) {
  const std::string bytes = to_bytes(ball()).value();
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += 1 + bit / 200) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    try {
      EXPECT_EQ(phantom_from_bytes(damaged).surfaces().size(), 1U);
    } catch (const DamagedBytes&) {
    }
  }
}

TEST(PhantomBytesOfOthers, AreNone) {
  // Values that are not the background outside the band, and metadata, would be lost.
  const Phantom phantom = ball();
  const auto with = [&](const auto& change) {
    auto grids = std::make_shared<Grids>();
    const auto grid = phantom.grids().signed_distance[0]->deepCopy();
    change(*grid);
    grids->signed_distance = {grid};
    return Phantom(phantom.name(),
                   phantom.materials(),
                   phantom.background(),
                   phantom.surfaces(),
                   phantom.region_of_interest(),
                   phantom.suggested_position_m(),
                   grids);
  };
  EXPECT_TRUE(to_bytes(with([](FloatGrid&) {})));
  EXPECT_FALSE(to_bytes(with([](FloatGrid& grid) {
    grid.tree().setValueOff(openvdb::Coord(0, 0, 0), 0.5F * grid.background());
  })));
  EXPECT_FALSE(to_bytes(with(
      [](FloatGrid& grid) { grid.insertMeta("creator", openvdb::StringMetadata("another")); })));
  EXPECT_FALSE(to_bytes(with([](FloatGrid& grid) { grid.transform().postRotate(0.1); })));
  EXPECT_TRUE(to_bytes(with(
      [](FloatGrid& grid) { grid.transform().postTranslate(openvdb::Vec3d(0.1, 0.2, 0.3)); })));
}

}  // namespace
}  // namespace wobblebench::phantoms
