#include "sim/speckle/scatterers/hash_cells.h"

#include <cmath>

#include "sim/math/fast_math.h"
#include "sim/optics/beam_table.h"
#include "sim/speckle/scatterers/scatterer_cells.h"
#include "sim/speckle/scatterers/stream_compaction.h"
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
  // The parabola passes the nearest and farthest cells of a block, with a margin for its error.
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

namespace {

/// An offset outside every beam.
constexpr float kOutOfReach_m = 1e3f;
/// In fractions of a cell's sides.
const glm::dvec3 kOrigin(kHashOrigin[0], kHashOrigin[1], kHashOrigin[2]);

}  // namespace

BeamVector to_float(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

HashAxes hash_axes(const RestToBeam& map, double cell_m) {
  return {to_float(map.matrix[0] * (cell_m / kHashUnits[0])),
          to_float(map.matrix[1] * (cell_m / kHashUnits[1])),
          to_float(map.matrix[2] * (cell_m / kHashUnits[2])),
          static_cast<float>((map.matrix * (cell_m * (0.5 - kOrigin))).x)};
}

CellOrigin cell_origin(const RestToBeam& map, const glm::dvec3& low_corner_m, double cell_m) {
  return CellOrigin(to_float(map(low_corner_m + cell_m * kOrigin)));
}

void CellGrid::fill(const RestToBeam& map, double side_m, int divisions) {
  const double cell_m = side_m / divisions;
  const RestToBeam linear{map.matrix, glm::dvec3(0)};
  axes = hash_axes(map, cell_m);
  const auto half_along = [&](int row) {
    return static_cast<float>(0.5 * cell_m *
                              (std::abs(map.matrix[0][row]) + std::abs(map.matrix[1][row]) +
                               std::abs(map.matrix[2][row])));
  };
  half = {half_along(0), half_along(1), half_along(2)};
  const int cells = divisions * divisions * divisions;
  const auto room = static_cast<std::size_t>((cells + kCompactionWidth - 1) / kCompactionWidth) *
                    kCompactionWidth;
  axial.assign(room, 0.0f);
  elevation.assign(room, 0.0f);
  lateral.assign(room, kOutOfReach_m);
  origins.resize(room);
  for (int i = 0; i < cells; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const glm::dvec3 corner = cell_coordinates(i, divisions);
    const BeamVector center = to_float(linear(cell_m * (corner + 0.5)));
    axial[at] = center.axial;
    lateral[at] = center.lateral;
    elevation[at] = center.elevation;
    origins[at] = cell_origin(linear, cell_m * corner, cell_m);
  }
}

HashCellArrays HashCellQueue::reserve(std::size_t more) {
  const std::size_t needed = count + more + kCompactionWidth;
  if (origin_.size() < needed) {
    origin_.resize(2 * needed);
    seed_.resize(2 * needed);
    amplitude_.resize(2 * needed);
    mixed.resize(2 * needed);
    blocks.resize(2 * needed);
  }
  return cells().from(count);
}

HashCellArrays HashCellQueue::cells() {
  return {origin_.data(), seed_.data(), amplitude_.data()};
}

}  // namespace wobblebench::sim
