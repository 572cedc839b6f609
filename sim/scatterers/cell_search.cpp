#include "sim/scatterers/cell_search.h"

#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

/// The parabola through three points that are `step` apart, the middle one at `range`.
ReachAlong through(double before, double middle, double behind, double range, double step) {
  const double square = (before - 2 * middle + behind) / (2 * step * step);
  const double slope = (behind - before) / (2 * step);
  return {static_cast<float>(middle - range * (slope - square * range)),
          static_cast<float>(slope - 2 * square * range),
          static_cast<float>(square)};
}

WOBBLEBENCH_INLINE float reach_at(const ReachAlong& reach, float axial) {
  return reach.at_face + axial * (reach.slope + reach.square * axial);
}

template <BeamRim rim>
WOBBLEBENCH_INLINE void test_within(const CellMiddles& middles,
                                    int count,
                                    const CellTest& test,
                                    std::uint8_t* __restrict near) {
  const BeamVector corner = test.corner;
  const float half_lateral_m = test.half_lateral_m, half_elevation_m = test.half_elevation_m;
  const ParcelReach reach = test.reach;
  const float begin_m = test.begin_m, end_m = test.end_m;
  for (int i = 0; i < count; ++i) {
    const float axial = corner.axial + middles.axial[i];
    const float wide = reach_at(reach.lateral, axial);
    const float high = reach_at(reach.elevation, axial);
    // The cell's nearest place to the axis, at least; over the reach in both directions, but
    // without dividing.
    const float lateral = magnitude(corner.lateral + middles.lateral[i]) - half_lateral_m;
    const float elevation = magnitude(corner.elevation + middles.elevation[i]) - half_elevation_m;
    const float u = (lateral > 0.0f ? lateral : 0.0f) * high;
    const float v = (elevation > 0.0f ? elevation : 0.0f) * wide;
    near[i] = within_rim<rim>(u, v, wide * high) & (axial > begin_m) & (axial < end_m);
  }
}

}  // namespace

std::vector<ParcelReach> reaches_around(const BeamTable& table, double parcel_m) {
  // Wide enough for what is nearest and farthest in a parcel, and a little for what bends more.
  constexpr double kSlack = 1.02;
  const double step_m = 0.6 * parcel_m;
  std::vector<ParcelReach> reaches;
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
    reaches.push_back({parabola(table.lateral()), parabola(table.elevation())});
  }
  return reaches;
}

WOBBLEBENCH_SIMD void test_cells(const CellMiddles& middles,
                                 int count,
                                 const CellTest& test,
                                 std::uint8_t* near) {
  if (test.rim == BeamRim::ellipse) {
    test_within<BeamRim::ellipse>(middles, count, test, near);
  } else {
    test_within<BeamRim::diamond>(middles, count, test, near);
  }
}

WOBBLEBENCH_SIMD void choose_kind(const std::uint8_t* near,
                                  const CellKind* kinds,
                                  CellKind wanted,
                                  int count,
                                  std::uint8_t* __restrict chosen) {
  for (int i = 0; i < count; ++i) {
    chosen[i] = static_cast<std::uint8_t>(near[i] & static_cast<std::uint8_t>(kinds[i] == wanted));
  }
}

}  // namespace wobblebench::sim
