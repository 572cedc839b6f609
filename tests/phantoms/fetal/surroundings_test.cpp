// Hand, cord and placenta before the face, on the grids.
#include <gtest/gtest.h>

#include <algorithm>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

const FloatGrid& grid(const Phantom& phantom, const std::string& name) {
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    if (phantom.surfaces()[i].name == name) return *phantom.grids().signed_distance[i];
  }
  throw std::logic_error("no surface " + name);
}

// Least distance of the skin from the surface `name`, by the voxels near both, inside the latter.
double least_gap(const Phantom& phantom, const std::string& name) {
  const auto skin = grid(phantom, "skin").getConstAccessor();
  double least = 1;
  for (auto voxel = grid(phantom, name).cbeginValueOn(); voxel; ++voxel) {
    const double to_skin = double(skin.getValue(voxel.getCoord()));
    if (*voxel > 0 || to_skin > 1.9e-3) continue;  // beyond the narrow band
    least = std::min(least, to_skin + double(*voxel));
  }
  return least;
}

class Before : public testing::TestWithParam<double> {};

TEST_P(Before, HandLiesAtItsGap) {
  PhantomOptions options;
  options.hand = HandPlace::before;
  options.hand_gap_m = GetParam() * 1e-3;
  const Phantom phantom = make_phantom(options);
  EXPECT_NEAR(least_gap(phantom, "hand"), options.hand_gap_m, 0.5e-3);
}

TEST_P(Before, CordLiesAtItsGap) {
  PhantomOptions options;
  options.cord = CordPlace::before;
  options.cord_gap_m = GetParam() * 1e-3;
  options.gestational_age_weeks = 24;
  const Phantom phantom = make_phantom(options);
  // Three strands make the cord: it is thinner between them.
  EXPECT_GT(least_gap(phantom, "cord"), options.cord_gap_m - 0.5e-3);
  EXPECT_LT(least_gap(phantom, "cord"), options.cord_gap_m + 1.5e-3);
}

INSTANTIATE_TEST_SUITE_P(Gaps, Before, testing::Values(0.0, 1.0));

TEST(Placenta, LiesOnTheFrontWallAndIsRefusedWhereItTouchesTheFace) {
  PhantomOptions options;
  options.placenta_m = 10e-3;
  options.voxel_m = 1e-3;
  const Phantom phantom = make_phantom(options);
  const auto& placenta = grid(phantom, "placenta");
  const auto cavity = grid(phantom, "cavity").getConstAccessor();
  double inside = 0;
  for (auto voxel = placenta.cbeginValueOn(); voxel; ++voxel) {
    if (*voxel < 0 && cavity.getValue(voxel.getCoord()) < 0) inside += 1;
  }
  EXPECT_GT(inside, 1000);
  options.placenta_m = 30e-3;
  const std::string refusal = refusal_of<InvalidPhantom>([&] { make_phantom(options); });
  EXPECT_TRUE(refusal.starts_with("placenta_mm = 30: must be at most ")) << refusal;
}

}  // namespace
}  // namespace wobblebench::phantoms
