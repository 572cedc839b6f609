// Scatterers as hashes of tissue cells: density, echoes, and what octaves must not change.
// Statistics of whole scans are in tests/physics/speckle_test.py.
#include "sim/speckle/scatterers/scatterer_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <string>

#include "phantoms/phantom.h"
#include "sim/losses/losses.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/speckle/iq_field.h"
#include "sim/speckle/scatterers/scatterer_cells.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {
namespace {

using Stick = std::vector<std::complex<float>>;

/// Sticks so far apart that they share no scatterers.
const hw::AcquisitionPlan& field_plan() {
  static const hw::AcquisitionPlan shared(
      {},
      {.depth_m = 0.15, .fan_rad = 100 * kDegree, .sticks_per_frame = 16, .frames_per_volume = 16});
  return shared;
}

/// Made once for each name.
ScannedTissue tissue_of(const std::string& name, const phantoms::Motion& motion = {}) {
  static std::map<std::string, ScannedTissue> cache;
  auto& tissue = cache[name];
  if (!tissue.map) {
    const auto phantom = phantoms::make_phantom({.name = name, .voxel_m = 1e-3});
    tissue = {std::make_shared<const TissueMap>(phantom, 2e-3, 0),
              phantom.materials(),
              {glm::dmat3(1.0), phantom.suggested_position_m()},
              {}};
  }
  ScannedTissue moving = tissue;
  moving.motion = motion;
  return moving;
}

SimulationOptions options_of(std::uint64_t seed = 1) {
  SimulationOptions options;
  options.fidelity = Rung::scatterers;
  options.seed = seed;
  return options;
}

struct Grid {
  int samples;
  double spacing_m;
  std::vector<float> remaining;

  Grid() {
    const auto field = make_iq_field(field_plan());
    samples = field.samples;
    spacing_m = field.spacing_m;
    remaining.assign(static_cast<std::size_t>(samples), 1.0f);
  }
};

const Grid& grid() {
  static const Grid shared;
  return shared;
}

StickPath path_of(const hw::StickIndex& index) {
  return {stick_ray(field_plan(), index), grid().spacing_m, grid().remaining, {}};
}

Stick echoes(const ScattererField& field, const hw::StickIndex& index) {
  Stick iq(grid().remaining.size());
  field.add_echoes(path_of(index), iq);
  return iq;
}

/// RMS difference of two sticks from a range on, relative to the first one's RMS there.
double difference(const Stick& a, const Stick& b, double from_m = 0) {
  double apart = 0, power = 0;
  for (auto i = static_cast<std::size_t>(from_m / grid().spacing_m); i < a.size(); ++i) {
    apart += static_cast<double>(std::norm(a[i] - b[i]));
    power += static_cast<double>(std::norm(a[i]));
  }
  return std::sqrt(apart / power);
}

TEST(ScattererCells, HoldTheDensityAskedFor) {
  for (double widest : {1.0, 1.9, 4.5, 40.0, 1e4}) {
    const ScattererCells cells(9e9, widest, 1);
    double sum = 0;
    for (const Octave& octave : cells.octaves) sum += octave.per_m3;
    EXPECT_NEAR(sum / 9e9, 1, 1e-12) << widest;
  }
}

TEST(ScattererCells, AsManyContributeAsAreNeededAndHardlyMore) {
  const ScattererCells cells(9e9, 32, 1);
  const int count = static_cast<int>(cells.octaves.size());
  EXPECT_EQ(count, 6);
  for (int step = 0; step < 67; ++step) {
    const double needed = 9e9 * std::pow(1.07, -step);
    double power = 0, square = 0, contributing = 0;
    for (int i = 0; i < count; ++i) {
      const double each = cells.octaves[static_cast<std::size_t>(i)].per_m3 / kScatterersInCell;
      for (int scatterer = 0; scatterer < kScatterersInCell; ++scatterer) {
        const double relative = scatterer_power(cells.share(i, needed), scatterer);
        power += each * relative;
        square += each * relative * relative;
        contributing += relative > 0 ? each : 0;
      }
    }
    EXPECT_NEAR(power / needed, 1, 1e-9);
    EXPECT_GE(power * power / square, 0.999999 * needed);
    // In the octave of the transition one scatterer of each cell contributes partly.
    if (cells.share(1, needed) > 0) {
      EXPECT_LT(contributing / needed, 1.1) << needed;
    }
  }
}

TEST(ScattererCells, OffsetsFillTheCell) {
  glm::dvec3 mean(0), square(0);
  constexpr int kCells = 20000;
  for (std::uint32_t cell = 0; cell < kCells; ++cell) {
    const std::uint32_t key = hash_cell_key(77, cell);
    for (std::uint32_t i = 0; i < kScatterersInCell; ++i) {
      const glm::dvec3 share = scatterer_position(key, i);
      mean += share / (1.0 * kCells * kScatterersInCell);
      square += share * share / (1.0 * kCells * kScatterersInCell);
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(mean[axis], 0.5, 3e-3);
    EXPECT_NEAR(square[axis] - mean[axis] * mean[axis], 1.0 / 12, 1e-3);
  }
}

/// The vectorised projection against a search in double precision, scatterer by scatterer.
TEST(Scatterers, EchoesAreThoseOfTheScatterersNearby) {
  for (const char* name : {"speckle_block", "cyst", "sphere"}) {
    const auto tissue = tissue_of(name);
    const ScattererField field(tissue, ProbeOptics(field_plan()), options_of());
    for (const hw::StickIndex& index : {hw::StickIndex{0, 8, 8}, hw::StickIndex{0, 7, 6}}) {
      Stick point_echoes(grid().remaining.size());
      const auto near =
          field.near(stick_ray(field_plan(), index), field_plan().acquisition().depth_m + 5e-3);
      ASSERT_GT(near.size(), 500u) << name;
      field.add_points(path_of(index), near, point_echoes);
      // Cells use the row of the beam's table at their centre, points that at their own position.
      // Near the face the beam changes most from row to row, and cells are largest.
      const Stick together = echoes(field, index);
      EXPECT_LT(difference(point_echoes, together), 0.25) << name;
      EXPECT_LT(difference(point_echoes, together, 60e-3), 0.08) << name;
    }
  }
}

TEST(Scatterers, FluidHasNone) {
  const auto tissue = tissue_of("sphere");
  const ScattererField field(tissue, ProbeOptics(field_plan()), options_of());
  // The outermost stick passes the sphere by.
  std::uint64_t contributed = 0;
  Stick iq(grid().remaining.size());
  field.add_echoes(path_of({0, 0, 0}), iq, &contributed);
  EXPECT_EQ(contributed, 0u);
  EXPECT_TRUE(field.near(stick_ray(field_plan(), {0, 0, 0}), 0.15).empty());
}

/// Mean intensity over all sticks of a few seeds about some ranges, over the material's.
std::vector<double> mean_power(bool all_octaves, const std::vector<double>& ranges_m) {
  const auto tissue = tissue_of("speckle_block");
  const double mean = amplitude_of_db(phantoms::material("soft_tissue").backscatter_db);
  std::vector<double> sums(ranges_m.size(), 0.0);
  double count = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    ScattererSettings model;
    model.all_octaves = all_octaves;
    const ScattererField field(tissue, ProbeOptics(field_plan()), options_of(seed), model);
    for (std::uint32_t f = 3; f < 13; ++f) {
      for (std::uint32_t l = 3; l < 13; ++l) {
        const Stick iq = echoes(field, {0, f, l});
        for (std::size_t r = 0; r < ranges_m.size(); ++r) {
          const int middle = static_cast<int>(ranges_m[r] / grid().spacing_m);
          for (int k = middle - 20; k <= middle + 20; k += 4) {
            sums[r] += static_cast<double>(std::norm(iq[static_cast<std::size_t>(k)]));
            count += r == 0;
          }
        }
      }
    }
  }
  for (double& sum : sums) sum /= count * 4 / kPi * mean * mean;
  return sums;
}

TEST(Scatterers, OctavesKeepTheMeanEcho) {
  // In the block, in the focus and where the beam is four times as wide.
  const std::vector<double> ranges_m = {75e-3, 95e-3, 105e-3};
  const auto few = mean_power(false, ranges_m), all = mean_power(true, ranges_m);
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    EXPECT_NEAR(few[i], 1, 0.1) << ranges_m[i];
    EXPECT_NEAR(all[i], 1, 0.1) << ranges_m[i];
  }
}

TEST(Scatterers, AreTheSeedsOwn) {
  const auto tissue = tissue_of("speckle_block");
  const ScattererField first(tissue, ProbeOptics(field_plan()), options_of(1)),
      again(tissue, ProbeOptics(field_plan()), options_of(1)),
      other(tissue, ProbeOptics(field_plan()), options_of(2));
  const hw::StickIndex index{0, 8, 8};
  EXPECT_EQ(echoes(first, index), echoes(again, index));
  EXPECT_GT(difference(echoes(first, index), echoes(other, index)), 1);
}

TEST(Scatterers, GoWhereTheTissueGoes) {
  phantoms::MotionOptions moving;
  moving.velocity_m_s = {0.01, -0.02, 0.03};
  const auto still = tissue_of("speckle_block");
  const auto moved = tissue_of("speckle_block", {moving, {}});
  const ScattererField here(still, ProbeOptics(field_plan()), options_of()),
      there(moved, ProbeOptics(field_plan()), options_of());
  TimedRay line = stick_ray(field_plan(), {0, 8, 8});
  line.time_s = 0.1;
  // The same ray relative to the moved tissue.
  const glm::dvec3 shift_m(0.001, -0.002, 0.003);
  TimedRay back = line;
  back.ray.origin -= shift_m;
  const auto a = there.near(line, 0.12), b = here.near(back, 0.12);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); i += 97) {
    EXPECT_LT(glm::distance(a[i].position_m, b[i].position_m + shift_m), 1e-9);
    EXPECT_NEAR(a[i].amplitude, b[i].amplitude, 1e-5f);
  }
}

}  // namespace
}  // namespace wobblebench::sim
