#include "sim/speckle/scatterers/hash_cells.h"

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

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

void CellGrid::number_cells(int divisions) {
  if (divisions == divisions_) return;
  divisions_ = divisions;
  const int cells = divisions * divisions * divisions;
  const auto room = static_cast<std::size_t>((cells + kCompactionWidth - 1) / kCompactionWidth) *
                    kCompactionWidth;
  for (std::vector<float>* values : {&x_, &y_, &z_, &axial, &lateral, &elevation}) {
    values->assign(room, 0.0f);
  }
  origins.resize(room);
  for (int i = 0; i < cells; ++i) {
    const glm::dvec3 middle = cell_coordinates(i, divisions) + 0.5;
    const auto at = static_cast<std::size_t>(i);
    x_[at] = static_cast<float>(middle.x);
    y_[at] = static_cast<float>(middle.y);
    z_[at] = static_cast<float>(middle.z);
  }
}

namespace {

/// out[i] = x[i] * along.x + y[i] * along.y + z[i] * along.z
WOBBLEBENCH_SIMD void place_cells(const float* x,
                                  const float* y,
                                  const float* z,
                                  std::size_t count,
                                  const glm::vec3& along,
                                  float* __restrict out) {
  const float along_x = along.x, along_y = along.y, along_z = along.z;
  for (std::size_t i = 0; i < count; ++i) out[i] = x[i] * along_x + y[i] * along_y + z[i] * along_z;
}

}  // namespace

void CellGrid::fill(const RestToBeam& map, double side_m, int divisions) {
  number_cells(divisions);
  const double cell_m = side_m / divisions;
  axes = hash_axes(map, cell_m);
  const glm::dmat3 rows = glm::transpose(cell_m * map.matrix);
  std::vector<float>* const centers[] = {&axial, &lateral, &elevation};
  float halves[3] = {};
  for (int row = 0; row < 3; ++row) {
    const glm::dvec3& along = rows[row];
    place_cells(x_.data(), y_.data(), z_.data(), x_.size(), along, centers[row]->data());
    halves[row] =
        static_cast<float>(0.5 * (std::abs(along.x) + std::abs(along.y) + std::abs(along.z)));
  }
  half = {halves[0], halves[1], halves[2]};
  const CellOrigin from_center(to_float(map.matrix * (cell_m * (kOrigin - 0.5))));
  for (std::size_t i = 0; i < origins.size(); ++i) {
    origins[i] = CellOrigin({axial[i], lateral[i], elevation[i]}) + from_center;
  }
  const auto cells = static_cast<std::ptrdiff_t>(divisions) * divisions * divisions;
  std::fill(lateral.begin() + cells, lateral.end(), kOutOfReach_m);
}

HashCellArrays HashCellQueue::reserve(std::size_t more) {
  const std::size_t needed = count + more + kCompactionWidth;
  if (origin_.size() < needed) {
    origin_.resize(2 * needed);
    seed_.resize(2 * needed);
    amplitude_.resize(2 * needed);
    mixed.resize(2 * needed);
    blocks.resize(2 * needed);
    axes.resize(2 * needed);
    directions.resize(2 * needed);
  }
  return cells().from(count);
}

HashCellArrays HashCellQueue::cells() {
  return {origin_.data(), seed_.data(), amplitude_.data()};
}

}  // namespace wobblebench::sim
