#include "phantoms/material.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

TEST(Material, TableHoldsThePublishedFigures) {
  EXPECT_DOUBLE_EQ(material("water").sound_speed_m_s, 1480);
  EXPECT_DOUBLE_EQ(material("amniotic_fluid").impedance_rayl, 1.51e6);
  EXPECT_DOUBLE_EQ(material("fetal_skin").impedance_rayl, 1.65e6);
  EXPECT_DOUBLE_EQ(material("muscle").attenuation_db_per_cm_mhz, 1.09);
  EXPECT_DOUBLE_EQ(material("fetal_skull").sound_speed_m_s, 2500);
  EXPECT_DOUBLE_EQ(material("cortical_bone").impedance_rayl, 6.5e6);
}

TEST(Material, EveryRowIsPhysicalUniqueAndSourced) {
  std::set<std::string> names;
  for (const Material& row : material_table()) {
    SCOPED_TRACE(row.name);
    EXPECT_TRUE(names.insert(row.name).second);
    EXPECT_GT(row.sound_speed_m_s, 1000);
    EXPECT_GT(row.impedance_rayl, 1e6);
    EXPECT_GE(row.attenuation_db_per_cm_mhz, 0);
    EXPECT_LE(row.backscatter_db, 0);
    EXPECT_TRUE(row.roughness >= 0 && row.roughness <= 1);
    EXPECT_FALSE(row.source.empty());
    // Backscatter is assumed in every row that scatters.
    const bool is_marked = row.source.find("assumed") != std::string::npos;
    EXPECT_TRUE(is_marked || row.backscatter_db == -200);
  }
}

TEST(Material, UnknownNameThrowsWithAllNames) {
  const std::string refusal = refusal_of<std::out_of_range>([&] { material("no_such_material"); });
  EXPECT_TRUE(holds(refusal, "no_such_material"));
  EXPECT_TRUE(holds(refusal, "fetal_skin"));
}

}  // namespace
}  // namespace wobblebench::phantoms
