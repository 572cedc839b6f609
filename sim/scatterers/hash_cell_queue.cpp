#include "sim/scatterers/hash_cell_queue.h"

#include <cmath>

namespace wobblebench::sim {

namespace {

/// Out of every beam's reach.
constexpr float kFarAside_m = 1e3f;
/// In shares of a cell's sides.
const glm::dvec3 kOrigin(kHashOrigin[0], kHashOrigin[1], kHashOrigin[2]);

}  // namespace

BeamVector narrow(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

HashAxes hash_axes(const RestToBeam& map, double cell_m) {
  return {narrow(map.turn[0] * (cell_m / kHashUnits[0])),
          narrow(map.turn[1] * (cell_m / kHashUnits[1])),
          narrow(map.turn[2] * (cell_m / kHashUnits[2])),
          static_cast<float>((map.turn * (cell_m * (0.5 - kOrigin))).x)};
}

CellOrigin cell_origin(const RestToBeam& map, const glm::dvec3& low_corner_m, double cell_m) {
  return CellOrigin(narrow(map(low_corner_m + cell_m * kOrigin)));
}

glm::dvec3 cell_place(int number, int divisions) {
  return {number % divisions, number / divisions % divisions, number / (divisions * divisions)};
}

void CellGrid::fill(const RestToBeam& map, double side_m, int divisions) {
  const double cell_m = side_m / divisions;
  const RestToBeam turned{map.turn, glm::dvec3(0)};
  axes = hash_axes(map, cell_m);
  const auto half_along = [&](int row) {
    return static_cast<float>(
        0.5 * cell_m *
        (std::abs(map.turn[0][row]) + std::abs(map.turn[1][row]) + std::abs(map.turn[2][row])));
  };
  half = {half_along(0), half_along(1), half_along(2)};
  const int cells = divisions * divisions * divisions;
  const auto room =
      static_cast<std::size_t>((cells + kFlagsTogether - 1) / kFlagsTogether) * kFlagsTogether;
  axial.assign(room, 0.0f);
  elevation.assign(room, 0.0f);
  lateral.assign(room, kFarAside_m);
  origins.resize(room);
  for (int i = 0; i < cells; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const glm::dvec3 place = cell_place(i, divisions);
    const BeamVector middle = narrow(turned(cell_m * (place + 0.5)));
    axial[at] = middle.axial;
    lateral[at] = middle.lateral;
    elevation[at] = middle.elevation;
    origins[at] = cell_origin(turned, cell_m * place, cell_m);
  }
}

TouchedHashCells HashCellQueue::next(std::size_t more) {
  const std::size_t needed = count + more + kFlagsTogether;
  if (origin_.size() < needed) {
    origin_.resize(2 * needed);
    seed_.resize(2 * needed);
    amplitude_.resize(2 * needed);
    mixed.resize(2 * needed);
    parcels.resize(2 * needed);
  }
  return cells().from(count);
}

TouchedHashCells HashCellQueue::cells() {
  return {origin_.data(), seed_.data(), amplitude_.data()};
}

}  // namespace wobblebench::sim
