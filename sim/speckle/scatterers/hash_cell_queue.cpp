#include "sim/speckle/scatterers/hash_cell_queue.h"

#include <cmath>

#include "sim/speckle/scatterers/scatterer_cells.h"
#include "sim/speckle/scatterers/stream_compaction.h"

namespace wobblebench::sim {

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
