#include "sim/speckle/scatterers/cell_search.h"

#include "sim/math/simd.h"
#include "sim/optics/beam_table.h"
#include "sim/speckle/scatterers/tissue_blocks.h"

namespace wobblebench::sim {

namespace {

/// The parabola through three points `step` apart, the middle one at `range`.
ReachParabola through(double before, double middle, double behind, double range, double step) {
  const double square = (before - 2 * middle + behind) / (2 * step * step);
  const double slope = (behind - before) / (2 * step);
  return {static_cast<float>(middle - range * (slope - square * range)),
          static_cast<float>(slope - 2 * square * range),
          static_cast<float>(square)};
}

WOBBLEBENCH_INLINE float reach_at(const ReachParabola& reach, float axial) {
  return reach.at_face + axial * (reach.slope + reach.square * axial);
}

template <BeamRim rim>
WOBBLEBENCH_INLINE void test_within(const CellCenters& centers,
                                    int count,
                                    const CellTest& test,
                                    std::uint8_t* __restrict touched) {
  const BeamVector corner = test.corner;
  const float half_lateral_m = test.half_lateral_m, half_elevation_m = test.half_elevation_m;
  const BlockReach reach = test.reach;
  const float begin_m = test.begin_m, end_m = test.end_m;
  for (int i = 0; i < count; ++i) {
    const float axial = corner.axial + centers.axial[i];
    const float lateral_reach = reach_at(reach.lateral, axial);
    const float elevation_reach = reach_at(reach.elevation, axial);
    // Lower bounds of the cell's offsets, over the reach in both directions, multiplied out to
    // avoid divisions.
    const float lateral = magnitude(corner.lateral + centers.lateral[i]) - half_lateral_m;
    const float elevation = magnitude(corner.elevation + centers.elevation[i]) - half_elevation_m;
    const float u = (lateral > 0.0f ? lateral : 0.0f) * elevation_reach;
    const float v = (elevation > 0.0f ? elevation : 0.0f) * lateral_reach;
    touched[i] = within_rim<rim>(u, v, lateral_reach * elevation_reach) & (axial > begin_m) &
                 (axial < end_m);
  }
}

}  // namespace

std::vector<BlockReach> reaches_around(const BeamTable& table,
                                       const BeamTable::Direction& lateral,
                                       double block_m) {
  // For the nearest and farthest cells of a block, with a margin for the parabola's error.
  constexpr double kSlack = 1.02;
  const double step_m = 0.6 * block_m;
  std::vector<BlockReach> reaches;
  for (int row = 0; row < table.rows(); ++row) {
    const double range_m = (row + 0.5) / table.rows_per_m();
    const int before = table.row(range_m - step_m), behind = table.row(range_m + step_m);
    const auto parabola = [&](const BeamTable::Direction& direction) {
      return through(kSlack * table.reach_m(direction, before),
                     kSlack * table.reach_m(direction, row),
                     kSlack * table.reach_m(direction, behind),
                     range_m,
                     step_m);
    };
    reaches.push_back({parabola(lateral), parabola(table.elevation())});
  }
  return reaches;
}

WOBBLEBENCH_SIMD void test_cells(const CellCenters& centers,
                                 int count,
                                 const CellTest& test,
                                 std::uint8_t* touched) {
  if (test.rim == BeamRim::ellipse) {
    test_within<BeamRim::ellipse>(centers, count, test, touched);
  } else {
    test_within<BeamRim::diamond>(centers, count, test, touched);
  }
}

WOBBLEBENCH_SIMD void select_kind(const std::uint8_t* touched,
                                  const CellKind* kinds,
                                  CellKind wanted,
                                  int count,
                                  std::uint8_t* __restrict selected) {
  for (int i = 0; i < count; ++i) {
    selected[i] =
        static_cast<std::uint8_t>(touched[i] & static_cast<std::uint8_t>(kinds[i] == wanted));
  }
}

}  // namespace wobblebench::sim
