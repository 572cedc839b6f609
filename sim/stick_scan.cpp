#include "sim/stick_scan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace wobblebench::sim {

namespace {

/// Echoes are made when there are this many: they stay in the first-level cache.
constexpr std::size_t kPending = 1024;
/// Out of every beam's reach.
constexpr float kFarAside_m = 1e3f;
/// Scatterers may be out of place by this much where tissue turns in itself.
constexpr double kStraight_m = 2e-6;
/// Cells of such tissue are taken as larger than they are by this factor.
constexpr float kStretch = 1.5f;

BeamVector narrow(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
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

/// Of the sound, at rest.
glm::vec3 direction_of(const RestToBeam& map) {
  return glm::vec3(glm::normalize(glm::transpose(map.turn)[0]));
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
  const int cells = divisions * divisions * divisions;
  const auto room =
      static_cast<std::size_t>((cells + kFlagsTogether - 1) / kFlagsTogether) * kFlagsTogether;
  for (auto* values : {&axial, &elevation, &corner_axial, &corner_lateral, &corner_elevation}) {
    values->assign(room, 0.0f);
  }
  lateral.assign(room, kFarAside_m);
  for (int i = 0; i < cells; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const glm::dvec3 place = cell_place(i, divisions);
    const BeamVector center = narrow(map.turn * (cell_m * (place + 0.5)));
    const BeamVector corner = narrow(map.turn * (cell_m * place));
    axial[at] = center.axial;
    lateral[at] = center.lateral;
    elevation[at] = center.elevation;
    corner_axial[at] = corner.axial;
    corner_lateral[at] = corner.lateral;
    corner_elevation[at] = corner.elevation;
  }
}

TouchedHashCells CellBatch::next(std::size_t more) {
  const std::size_t needed = count + more + kFlagsTogether;
  if (row_.size() < needed) {
    for (auto* values : {&axial_, &lateral_, &elevation_, &amplitude_}) values->resize(2 * needed);
    mixed.resize(2 * needed);
    key_.resize(2 * needed);
    row_.resize(2 * needed);
  }
  return cells().from(count);
}

TouchedHashCells CellBatch::cells() {
  return {axial_.data(),
          lateral_.data(),
          elevation_.data(),
          amplitude_.data(),
          key_.data(),
          row_.data()};
}

StickScan::StickScan(const ScattererScene& scene, const StickWay& way, ScanBuffers& buffers)
    : scene_(scene), way_(way), buffers_(buffers), view_(scene.subject, way.line) {
  // A pulse whose middle lies beyond the last sample is still heard there.
  const double samples = static_cast<double>(way.left.size()) + scene.taps.beside();
  heard_m_ = samples * way.spacing_m;
  end_m_ = heard_m_ - (way.delay_m.empty() ? 0 : static_cast<double>(way.delay_m.back()));
  find_delays();
}

std::uint64_t StickScan::run(std::span<std::complex<float>> iq) {
  const ParcelLattice lattice = scene_.lattice();
  buffers_.bins.begin(scene_.taps, heard_m_);
  for (const auto turn : {phantoms::Moment::Turn::rests, phantoms::Moment::Turn::whole}) {
    if (view_.rigid() && turn == phantoms::Moment::Turn::whole) break;
    const auto part = static_cast<std::size_t>(turn);
    direction_[part] = direction_of(view_.whole(turn));
    fill_grids(view_.whole(turn), buffers_.grids[part]);
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
    pending_ += static_cast<std::size_t>(see_places(&place, 1, scene_.sight(nullptr), room_for(1)));
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
  std::vector<CellGrid>& grids = place_parcel(center, parcel);
  parcel.beam_corner = narrow(parcel.map(parcel.corner));
  parcel.reach = reach_around(touched.center.x);
  const auto row = static_cast<std::size_t>(scene_.table.row(touched.center.x));
  for (std::size_t i = 0; i < scene_.cells.octaves.size(); ++i) {
    if (!scene_.gains[i].heard[row]) continue;
    scan_octave(parcel, grids[i], static_cast<int>(i));
  }
}

void StickScan::fill_grids(const RestToBeam& map, std::vector<CellGrid>& grids) const {
  const auto& octaves = scene_.cells.octaves;
  grids.resize(octaves.size());
  for (std::size_t i = 0; i < octaves.size(); ++i) {
    grids[i].fill(map, scene_.parcels.side_m(), octaves[i].divisions);
  }
}

std::vector<CellGrid>& StickScan::place_parcel(const glm::dvec3& center, Parcel& parcel) {
  const double side_m = scene_.parcels.side_m();
  const auto turn = view_.turn_within(center, 0.5 * std::sqrt(3.0) * side_m);
  if (turn != phantoms::Moment::Turn::bends) {
    const auto part = static_cast<std::size_t>(turn);
    parcel.map = view_.whole(turn);
    parcel.direction = direction_[part];
    return buffers_.grids[part];
  }
  parcel.map = view_.map_near(center);
  parcel.straight = holds(parcel.map, view_, center, side_m);
  parcel.direction = direction_of(parcel.map);
  fill_grids(parcel.map, buffers_.bent);
  return buffers_.bent;
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

CellTest StickScan::cell_test(const Parcel& parcel, const CellGrid& grid, int octave) const {
  const float stretch = parcel.straight ? 1.0f : kStretch;
  const auto& gain = scene_.gains[static_cast<std::size_t>(octave)];
  return {parcel.beam_corner,
          {0, stretch * grid.half.lateral, stretch * grid.half.elevation},
          parcel.reach,
          static_cast<float>(scene_.table.rows_per_m()),
          scene_.table.rows() - 1,
          gain.first_row,
          gain.last_row,
          parcel.key,
          scene_.rim};
}

void StickScan::scan_octave(Parcel& parcel, const CellGrid& grid, int octave) {
  parcel.key =
      scene_.cells.octaves[static_cast<std::size_t>(octave)].parcel_key(parcel.tissue.index);
  test_cells(grid.places(), grid.count(), cell_test(parcel, grid, octave), buffers_.tested);
  take_near_cells(parcel, octave, grid.count());
  if (parcel.straight) see(parcel, grid.axes, octave);
  if (pending_ >= kPending) flush();
}

const std::uint8_t* StickScan::choose(const Parcel& parcel,
                                      int octave,
                                      int count,
                                      CellKind wanted) {
  // Behind an octave's cells lie the next one's, or nothing: those flags are 0.
  const CellKind* kinds = scene_.parcels.kinds(parcel.tissue, octave);
  choose_kind(buffers_.tested.near, kinds, wanted, count, buffers_.chosen);
  return buffers_.chosen;
}

void StickScan::take_near_cells(const Parcel& parcel, int octave, int count) {
  if (!parcel.straight) {
    take_bent_cells(parcel, octave, count);
  } else {
    take_even_cells(parcel, octave, count);
    if (parcel.tissue.mixed != nullptr) take_mixed_cells(parcel, octave, count);
  }
}

void StickScan::take_even_cells(const Parcel& parcel, int octave, int count) {
  const TissueParcels& parcels = scene_.parcels;
  CellBatch& batch = buffers_.even;
  const TouchedHashCells to = batch.next(static_cast<std::size_t>(count));
  if (parcel.tissue.mixed == nullptr) {
    const int taken = pack_cells(buffers_.tested, buffers_.tested.near, count, to);
    std::fill_n(to.amplitude, taken, parcels.amplitude(parcel.tissue.material));
    batch.count += static_cast<std::size_t>(taken);
    return;
  }
  const std::int16_t* codes = parcels.codes(parcel.tissue, octave);
  const std::uint8_t* even = choose(parcel, octave, count, CellKind::even);
  const int taken = pack_cells(buffers_.tested, even, count, to);
  list_flags(even, count, buffers_.list);
  for (int i = 0; i < taken; ++i) to.amplitude[i] = parcels.amplitude(codes[buffers_.list[i]]);
  batch.count += static_cast<std::size_t>(taken);
}

void StickScan::take_mixed_cells(const Parcel& parcel, int octave, int count) {
  const std::int16_t* codes = scene_.parcels.codes(parcel.tissue, octave);
  CellBatch& batch = buffers_.mixed;
  const TouchedHashCells to = batch.next(static_cast<std::size_t>(count));
  const std::uint8_t* mixed = choose(parcel, octave, count, CellKind::mixed);
  const int taken = pack_cells(buffers_.tested, mixed, count, to);
  list_flags(mixed, count, buffers_.list);
  std::fill_n(to.amplitude, taken, 1.0f);
  for (int i = 0; i < taken; ++i) {
    const MixedCell* cell = &TissueParcels::mixed_cell(parcel.tissue, codes[buffers_.list[i]]);
    __builtin_prefetch(cell);
    batch.mixed[batch.count++] = cell;
  }
}

void StickScan::take_bent_cells(const Parcel& parcel, int octave, int count) {
  const TissueParcels& parcels = scene_.parcels;
  const TestedCells& tested = buffers_.tested;
  const int near = list_flags(tested.near, count, buffers_.list);
  for (int i = 0; i < near; ++i) {
    const int number = buffers_.list[i];
    const int code = parcels.code(parcel.tissue, octave, number);
    const float amplitude = code >= 0 ? parcels.amplitude(code) : 1.0f;
    if (amplitude == 0) continue;
    CellBatch& batch = code >= 0 ? buffers_.even : buffers_.mixed;
    const TouchedHashCells cell = batch.next(1);
    cell.amplitude[0] = amplitude;
    cell.key[0] = tested.key[number];
    cell.row[0] = tested.row[number];
    const HashAxes axes = place_bent(parcel, octave, number, cell);
    if (code < 0) batch.mixed[0] = &TissueParcels::mixed_cell(parcel.tissue, code);
    batch.count = 1;
    see(parcel, axes, octave);
  }
}

HashAxes StickScan::place_bent(const Parcel& parcel,
                               int octave,
                               int number,
                               const TouchedHashCells& cell) const {
  const int n = scene_.cells.octaves[static_cast<std::size_t>(octave)].divisions;
  const double cell_m = scene_.parcels.side_m() / n;
  const glm::dvec3 low = parcel.corner + cell_m * cell_place(number, n);
  const RestToBeam map = view_.map_near(low + 0.5 * cell_m);
  const BeamVector corner = narrow(map(low));
  cell.axial[0] = corner.axial;
  cell.lateral[0] = corner.lateral;
  cell.elevation[0] = corner.elevation;
  return hash_axes(map, cell_m);
}

void StickScan::see(const Parcel& parcel, const HashAxes& axes, int octave) {
  const Sight sight = scene_.sight(scene_.gains[static_cast<std::size_t>(octave)].scaled.data());
  if (buffers_.even.count != 0) see_even(axes, sight);
  if (buffers_.mixed.count != 0) see_mixed(parcel, axes, sight);
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

void StickScan::see_even(const HashAxes& axes, const Sight& sight) {
  CellBatch& batch = buffers_.even;
  const SeenScatterers seen = room_for(batch.count);
  const int count = static_cast<int>(batch.count);
  pending_ += static_cast<std::size_t>(see_scatterers(batch.cells(), count, axes, sight, seen));
  batch.count = 0;
}

void StickScan::see_mixed(const Parcel& parcel, const HashAxes& axes, const Sight& sight) {
  CellBatch& batch = buffers_.mixed;
  const SeenScatterers seen = room_for(batch.count);
  int hits = 0;
  pending_ += static_cast<std::size_t>(see_mixed_scatterers(batch.cells(),
                                                            batch.mixed.data(),
                                                            static_cast<int>(batch.count),
                                                            axes,
                                                            sight,
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
  batch.count = 0;
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
