#include "sim/stick_scan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace wobblebench::sim {

namespace {

/// Echoes are made when there are this many: they stay in the first-level cache.
constexpr std::size_t kPending = 1024;
/// Hash cells are tested this many at a time.
constexpr int kCells = 256;
/// Scatterers may be out of place by this much where tissue turns in itself.
constexpr double kStraight_m = 2e-6;
/// Cells of such tissue are taken as larger than they are by this factor.
constexpr float kStretch = 1.5f;

BeamVector narrow(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

BeamVector operator+(const BeamVector& a, const BeamVector& b) {
  return {a.axial + b.axial, a.lateral + b.lateral, a.elevation + b.elevation};
}

HashAxes hash_axes(const RestToBeam& map, double cell_m) {
  return {narrow(map.turn[0] * (cell_m / kHashUnits[0])),
          narrow(map.turn[1] * (cell_m / kHashUnits[1])),
          narrow(map.turn[2] * (cell_m / kHashUnits[2]))};
}

/// Is the map as good at a cube's corners as in its middle?
bool holds(const RestToBeam& map, const StickView& view, const glm::dvec3& center, double side_m) {
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at =
        center +
        0.5 * side_m * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    if (glm::distance(map(at), view.to_beam(at)) > kStraight_m) return false;
  }
  return true;
}

glm::dvec3 cell_place(int number, int divisions) {
  return {number % divisions, number / divisions % divisions, number / (divisions * divisions)};
}

/// The parabola through three points that are `step` apart, the middle one at `range`.
ReachAlong through(double before, double middle, double behind, double range, double step) {
  const double square = (before - 2 * middle + behind) / (2 * step * step);
  const double slope = (behind - before) / (2 * step);
  return {static_cast<float>(middle - range * (slope - square * range)),
          static_cast<float>(slope - 2 * square * range),
          static_cast<float>(square)};
}

}  // namespace

void CellGrid::fill(const RestToBeam& map, double side_m, int divisions) {
  const double cell_m = side_m / divisions;
  axes = hash_axes(map, cell_m);
  const auto half_along = [&](int row) {
    return static_cast<float>(
        0.5 * cell_m *
        (std::abs(map.turn[0][row]) + std::abs(map.turn[1][row]) + std::abs(map.turn[2][row])));
  };
  half = {half_along(0), half_along(1), half_along(2)};
  axial.clear();
  lateral.clear();
  elevation.clear();
  corner.clear();
  for (int i = 0; i < divisions * divisions * divisions; ++i) {
    const glm::dvec3 place = cell_place(i, divisions);
    const BeamVector at = narrow(map.turn * (cell_m * (place + 0.5)));
    axial.push_back(at.axial);
    lateral.push_back(at.lateral);
    elevation.push_back(at.elevation);
    corner.push_back(narrow(map.turn * (cell_m * place)));
  }
}

void CellBatch::clear() {
  cells.clear();
  mixed.clear();
}

StickScan::StickScan(const ScattererScene& scene, const StickWay& way, ScanBuffers& buffers)
    : scene_(scene), way_(way), buffers_(buffers), view_(scene.subject, way.line) {
  // A pulse whose middle lies beyond the last sample is still heard there.
  const double samples = static_cast<double>(way.left.size()) + scene.taps.beside();
  heard_m_ = samples * way.spacing_m;
  end_m_ = heard_m_ - (way.delay_m.empty() ? 0 : static_cast<double>(way.delay_m.back()));
  buffers_.near.resize(kCells + kFlagsTogether);
  buffers_.list.resize(kCells + kFlagsTogether);
  find_delays();
}

std::uint64_t StickScan::run(std::span<std::complex<float>> iq) {
  const ParcelLattice lattice = scene_.lattice();
  const auto& octaves = scene_.cells.octaves;
  buffers_.bins.begin(scene_.taps, heard_m_);
  buffers_.grids.resize(octaves.size());
  if (view_.rigid()) {
    for (std::size_t i = 0; i < octaves.size(); ++i) {
      buffers_.grids[i].fill(view_.map(), lattice.side_m, octaves[i].divisions);
    }
  }
  find_touched(view_, scene_.tube, lattice, end_m_, buffers_.touched);
  for (const TouchedParcel& touched : buffers_.touched) scan(touched);
  flush();
  buffers_.bins.finish(scene_.taps, way_.left, iq);
  return total_;
}

std::uint64_t StickScan::run(std::span<const PointEcho> points, std::span<std::complex<float>> iq) {
  buffers_.bins.begin(scene_.taps, heard_m_);
  const AcrossStick across = across_stick(way_.line.ray);
  for (const PointEcho& point : points) {
    const glm::dvec3 from_face = point.position_m - way_.line.ray.origin;
    const glm::dvec3 at(glm::dot(from_face, way_.line.ray.direction),
                        glm::dot(from_face, across.lateral),
                        glm::dot(from_face, across.elevation));
    const BeamPlace place{narrow(at), point.amplitude, scene_.table.row(at.x)};
    pending_ += static_cast<std::size_t>(see_places(&place, 1, scene_.sight(), room_for(1)));
  }
  flush();
  buffers_.bins.finish(scene_.taps, way_.left, iq);
  return total_;
}

void StickScan::scan(const TouchedParcel& touched) {
  Parcel parcel;
  parcel.tissue = scene_.parcels.parcel(touched.index);
  if (scene_.parcels.silent(parcel.tissue)) return;
  const ParcelLattice lattice = scene_.lattice();
  const glm::dvec3 center = lattice.center(touched.index);
  parcel.corner = center - 0.5 * lattice.side_m;
  parcel.map = view_.rigid() ? view_.map() : view_.map_near(center, lattice.side_m);
  parcel.straight = view_.rigid() || holds(parcel.map, view_, center, lattice.side_m);
  parcel.beam_corner = narrow(parcel.map(parcel.corner));
  parcel.direction = glm::vec3(glm::normalize(glm::transpose(parcel.map.turn)[0]));
  parcel.reach = reach_around(touched.center.x);
  const auto row = static_cast<std::size_t>(scene_.table.row(touched.center.x));
  for (std::size_t i = 0; i < scene_.cells.octaves.size(); ++i) {
    if (!scene_.gains[i].heard[row]) continue;
    CellGrid& grid = buffers_.grids[i];
    if (!view_.rigid()) {
      grid.fill(parcel.map, lattice.side_m, scene_.cells.octaves[i].divisions);
    }
    scan_octave(parcel, grid, static_cast<int>(i));
  }
}

ParcelReach StickScan::reach_around(double range_m) const {
  // Wide enough for what is nearest and farthest in a parcel, and a little for what bends more.
  constexpr double kSlack = 1.02;
  const double step_m = 0.6 * scene_.parcels.side_m();
  const BeamTable& table = scene_.table;
  const int before = table.row(range_m - step_m), middle = table.row(range_m),
            behind = table.row(range_m + step_m);
  const auto parabola = [&](const BeamTable::Direction& direction) {
    return through(kSlack * table.reach_m(direction, before),
                   kSlack * table.reach_m(direction, middle),
                   kSlack * table.reach_m(direction, behind),
                   range_m,
                   step_m);
  };
  return {parabola(table.lateral()), parabola(table.elevation())};
}

void StickScan::scan_octave(Parcel& parcel, const CellGrid& grid, int octave) {
  const Octave& process = scene_.cells.octaves[static_cast<std::size_t>(octave)];
  const float stretch = parcel.straight ? 1.0f : kStretch;
  const BeamVector half{0, stretch * grid.half.lateral, stretch * grid.half.elevation};
  parcel.key = process.parcel_key(parcel.tissue.index);
  for (int first = 0; first < process.cells(); first += kCells) {
    const int count = std::min(kCells, process.cells() - first);
    find_near_cells(
        {grid.axial.data() + first, grid.lateral.data() + first, grid.elevation.data() + first},
        count,
        parcel.beam_corner,
        half,
        parcel.reach,
        scene_.rim,
        buffers_.near.data());
    take_near_cells(parcel, grid, octave, first, count);
  }
  if (parcel.straight) see(parcel, grid.axes);
  if (pending_ >= kPending) flush();
}

TouchedHashCell StickScan::touched_cell(const Parcel& parcel,
                                        const CellGrid& grid,
                                        int number) const {
  const auto at = static_cast<std::size_t>(number);
  TouchedHashCell cell;
  cell.key = hash_cell_key(parcel.key, static_cast<std::uint32_t>(number));
  cell.row = std::clamp(static_cast<int>((parcel.beam_corner.axial + grid.axial[at]) *
                                         static_cast<float>(scene_.table.rows_per_m())),
                        0,
                        scene_.table.rows() - 1);
  cell.corner = parcel.beam_corner + grid.corner[at];
  return cell;
}

std::span<const std::int32_t> StickScan::list_near(int count) {
  std::fill_n(buffers_.near.begin() + count, kFlagsTogether, std::uint8_t{0});
  const int listed = list_flags(buffers_.near.data(), count, buffers_.list.data());
  return {buffers_.list.data(), static_cast<std::size_t>(listed)};
}

void StickScan::take_near_cells(
    const Parcel& parcel, const CellGrid& grid, int octave, int first, int count) {
  const std::span<const std::int32_t> near = list_near(count);
  if (parcel.tissue.mixed == nullptr && parcel.straight) {
    take_even_cells(parcel, grid, octave, first, near);
    return;
  }
  const TissueParcels& parcels = scene_.parcels;
  const float* gain = scene_.gains[static_cast<std::size_t>(octave)].scaled.data();
  for (const int i : near) {
    const int number = first + i;
    const int code = parcel.tissue.mixed == nullptr ? parcel.tissue.material
                                                    : parcels.code(parcel.tissue, octave, number);
    const float strength = code >= 0 ? parcels.amplitude(code) : 1.0f;
    TouchedHashCell cell = touched_cell(parcel, grid, number);
    cell.amplitude = strength * gain[cell.row];
    if (cell.amplitude == 0) continue;
    if (parcel.straight) {
      sort_cell(parcel, cell, code);
    } else {
      const HashAxes axes = place_bent(parcel, octave, number, cell);
      sort_cell(parcel, cell, code);
      see(parcel, axes);
    }
  }
}

void StickScan::take_even_cells(
    const Parcel& parcel, const CellGrid& grid, int octave, int first, std::span<const std::int32_t> near) {
  const float* gain = scene_.gains[static_cast<std::size_t>(octave)].scaled.data();
  const float strength = scene_.parcels.amplitude(parcel.tissue.material);
  auto& cells = buffers_.even.cells;
  const std::size_t before = cells.size();
  cells.resize(before + near.size());
  for (std::size_t n = 0; n < near.size(); ++n) {
    TouchedHashCell cell = touched_cell(parcel, grid, first + near[n]);
    cell.amplitude = strength * gain[cell.row];
    cells[before + n] = cell;
  }
}

void StickScan::sort_cell(const Parcel& parcel, const TouchedHashCell& cell, int code) {
  if (code >= 0) {
    buffers_.even.cells.push_back(cell);
  } else {
    buffers_.mixed.cells.push_back(cell);
    buffers_.mixed.mixed.push_back(&TissueParcels::mixed_cell(parcel.tissue, code));
  }
}

HashAxes StickScan::place_bent(const Parcel& parcel,
                               int octave,
                               int number,
                               TouchedHashCell& cell) const {
  const int n = scene_.cells.octaves[static_cast<std::size_t>(octave)].divisions;
  const double cell_m = scene_.parcels.side_m() / n;
  const glm::dvec3 low = parcel.corner + cell_m * cell_place(number, n);
  const RestToBeam map = view_.map_near(low + 0.5 * cell_m, cell_m);
  cell.corner = narrow(map(low));
  return hash_axes(map, cell_m);
}

void StickScan::see(const Parcel& parcel, const HashAxes& axes) {
  if (!buffers_.even.cells.empty()) see_even(axes);
  if (!buffers_.mixed.cells.empty()) see_mixed(parcel, axes);
}

SeenScatterers StickScan::room_for(std::size_t cells) {
  // One more, because cells are written as a whole.
  const std::size_t needed = pending_ + (cells + 1) * kScatterersInCell;
  if (buffers_.path_m.size() < needed) {
    buffers_.path_m.resize(2 * needed);
    buffers_.entry.resize(2 * needed);
    buffers_.amplitude.resize(2 * needed);
    buffers_.hits.resize(2 * needed);
  }
  return {buffers_.path_m.data() + pending_,
          buffers_.entry.data() + pending_,
          buffers_.amplitude.data() + pending_};
}

void StickScan::see_even(const HashAxes& axes) {
  CellBatch& batch = buffers_.even;
  const SeenScatterers seen = room_for(batch.cells.size());
  const int count = static_cast<int>(batch.cells.size());
  pending_ += static_cast<std::size_t>(
      see_scatterers(batch.cells.data(), count, axes, scene_.sight(), seen));
  batch.clear();
}

void StickScan::see_mixed(const Parcel& parcel, const HashAxes& axes) {
  CellBatch& batch = buffers_.mixed;
  const SeenScatterers seen = room_for(batch.cells.size());
  int hits = 0;
  pending_ += static_cast<std::size_t>(see_mixed_scatterers(batch.cells.data(),
                                                            batch.mixed.data(),
                                                            static_cast<int>(batch.cells.size()),
                                                            axes,
                                                            scene_.sight(),
                                                            seen,
                                                            buffers_.hits.data(),
                                                            &hits));
  for (int i = 0; i < hits; ++i) {
    const SheetHit& hit = buffers_.hits[static_cast<std::size_t>(i)];
    seen.amplitude[hit.seen] *=
        scene_.parcels.sheet_amplitude(parcel.tissue,
                                       *batch.mixed[static_cast<std::size_t>(hit.cell)],
                                       hit.scatterer,
                                       parcel.direction);
  }
  batch.clear();
}

void StickScan::flush() {
  if (!way_.delay_m.empty()) delay_paths();
  const EchoConstants constants{
      scene_.sections.words(),
      static_cast<float>(scene_.cycles_per_m),
      static_cast<float>(1 / scene_.taps.bin_m()),
      buffers_.bins.last_bin(),
      static_cast<float>(1 / (2 * kPi * scene_.cycles_per_m * scene_.taps.bin_m()))};
  const SeenScatterers seen{
      buffers_.path_m.data(), buffers_.entry.data(), buffers_.amplitude.data()};
  BinShare shares[kEchoBatch];
  std::int32_t at[kEchoBatch];
  for (std::size_t first = 0; first < pending_; first += kEchoBatch) {
    const int count = static_cast<int>(std::min<std::size_t>(kEchoBatch, pending_ - first));
    make_echoes(seen.from(first), count, constants, shares, at);
    buffers_.bins.add(shares, at, count);
  }
  total_ += pending_;
  pending_ = 0;
}

void StickScan::find_delays() {
  buffers_.delay_m.clear();
  if (way_.delay_m.empty()) return;
  const auto delay = [&](std::size_t i) { return static_cast<double>(way_.delay_m[i]); };
  const auto true_m = [&](std::size_t i) {
    return (static_cast<double>(i) + 0.5) * way_.spacing_m - delay(i);
  };
  const std::size_t last = way_.delay_m.size() - 1;
  std::size_t i = 0;
  const int count = static_cast<int>(std::ceil(end_m_ / way_.spacing_m)) + 1;
  for (int k = 0; k < count; ++k) {
    const double range = k * way_.spacing_m;
    while (i + 1 < last && true_m(i + 1) < range) ++i;
    const std::size_t next = std::min(i + 1, last);
    const double step = true_m(next) - true_m(i);
    const double share = step > 0 ? std::clamp((range - true_m(i)) / step, 0.0, 1.0) : 0.0;
    buffers_.delay_m.push_back(static_cast<float>(delay(i) + share * (delay(next) - delay(i))));
  }
}

void StickScan::delay_paths() {
  const float per_m = static_cast<float>(1 / way_.spacing_m);
  const int last = static_cast<int>(buffers_.delay_m.size()) - 2;
  for (std::size_t i = 0; i < pending_; ++i) {
    const float place = std::max(0.0f, buffers_.path_m[i] * per_m);
    const int before = std::clamp(static_cast<int>(place), 0, last);
    const float* delay = buffers_.delay_m.data() + before;
    const float share = std::min(place - static_cast<float>(before), 1.0f);
    buffers_.path_m[i] += delay[0] + share * (delay[1] - delay[0]);
  }
}

}  // namespace wobblebench::sim
