#include "sim/scatterers/stick_scan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace wobblebench::sim {

namespace {

/// Cells are looked at when there are this many: few lanes of wide loops are idle then.
constexpr std::size_t kCellsTogether = 4 * std::size_t{kLaneCells};
/// Scatterers may be out of place by this much where tissue turns in itself.
constexpr double kStraight_m = 2e-6;
/// Cells of such tissue are taken as larger than they are by this factor.
constexpr float kStretch = 1.5f;

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

}  // namespace

StickScan::StickScan(const ScattererScene& scene, const StickPath& way, ScanBuffers& buffers)
    : scene_(scene),
      way_(way),
      buffers_(buffers),
      view_(scene.subject, way.line),
      end_m_(HeardRange(scene, way).true_m) {}

std::uint64_t StickScan::run(std::span<std::complex<float>> iq) {
  find_touched(view_, scene_.tube, scene_.lattice(), end_m_, buffers_.touched);
  for (const TouchedParcel& touched : buffers_.touched) {
    const TissueParcels::Parcel tissue = scene_.parcels.parcel(touched.index);
    if (!scene_.parcels.silent(tissue)) scan(touched, tissue);
  }
  if (!begun_) return 0;
  see_rest();
  return buffers_.echoes.finish(iq);
}

std::uint64_t StickScan::run(std::span<const PointEcho> points, std::span<std::complex<float>> iq) {
  EchoQueue& echoes = buffers_.echoes;
  echoes.begin(scene_, way_);
  const AcrossStick across = across_stick(way_.line.ray);
  for (const PointEcho& point : points) {
    const glm::dvec3 from_face = point.position_m - way_.line.ray.origin;
    const glm::dvec3 at(glm::dot(from_face, way_.line.ray.direction),
                        glm::dot(from_face, across.lateral),
                        glm::dot(from_face, across.elevation));
    const BeamPlace place{narrow(at), point.amplitude, scene_.table.row(at.x)};
    echoes.take(see_place(place, scene_.sight(nullptr), echoes.room_for(1)));
  }
  return echoes.finish(iq);
}

void StickScan::begin() {
  begun_ = true;
  buffers_.echoes.begin(scene_, way_);
  for (const auto turn : {phantoms::Deformation::Turn::none, phantoms::Deformation::Turn::full}) {
    if (view_.rigid() && turn == phantoms::Deformation::Turn::full) break;
    const auto part = static_cast<std::size_t>(turn);
    direction_[part] = direction_of(view_.whole(turn));
    fill_grids(view_.whole(turn), buffers_.whole[part]);
  }
}

void StickScan::scan(const TouchedParcel& touched, const TissueParcels::Parcel& tissue) {
  if (!begun_) begin();
  Parcel parcel;
  parcel.tissue = tissue;
  const ParcelGrid lattice = scene_.lattice();
  const glm::dvec3 center = lattice.center(touched.index);
  parcel.corner = center - 0.5 * lattice.side_m;
  std::vector<OctaveCells>& octaves = place_parcel(center, parcel);
  parcel.beam_corner = narrow(parcel.map(parcel.corner));
  const auto row = static_cast<std::size_t>(scene_.table.row(touched.center.x));
  parcel.reach = scene_.reaches[row];
  for (std::size_t i = 0; i < scene_.cells.octaves.size(); ++i) {
    if (!scene_.gains[i].heard[row]) continue;
    scan_octave(parcel, octaves[i], static_cast<int>(i));
  }
}

void StickScan::fill_grids(const RestToBeam& map, std::vector<OctaveCells>& octaves) const {
  octaves.resize(scene_.cells.octaves.size());
  for (std::size_t i = 0; i < octaves.size(); ++i) {
    octaves[i].grid.fill(map, scene_.parcels.side_m(), scene_.cells.octaves[i].divisions);
  }
}

std::vector<OctaveCells>& StickScan::place_parcel(const glm::dvec3& center, Parcel& parcel) {
  const double side_m = scene_.parcels.side_m();
  const auto turn = view_.turn_within(center, 0.5 * std::sqrt(3.0) * side_m);
  if (turn != phantoms::Deformation::Turn::partial) {
    const auto part = static_cast<std::size_t>(turn);
    parcel.map = view_.whole(turn);
    parcel.direction = direction_[part];
    return buffers_.whole[part];
  }
  parcel.map = view_.map_near(center);
  parcel.bent = true;
  parcel.straight = holds(parcel.map, view_, center, side_m);
  parcel.direction = direction_of(parcel.map);
  fill_grids(parcel.map, buffers_.bent);
  return buffers_.bent;
}

CellTest StickScan::cell_test(const Parcel& parcel, const CellGrid& grid, int octave) const {
  const float stretch = parcel.straight ? 1.0f : kStretch;
  const float half_axial_m = stretch * grid.half.axial;
  const auto& heard = scene_.gains[static_cast<std::size_t>(octave)];
  return {parcel.beam_corner,
          stretch * grid.half.lateral,
          stretch * grid.half.elevation,
          parcel.reach,
          std::max(heard.begin_m, -half_axial_m),
          std::min(heard.end_m, static_cast<float>(end_m_) + half_axial_m),
          scene_.rim};
}

void StickScan::place_cells(const Parcel& parcel,
                            const CellGrid& grid,
                            int count,
                            const TouchedHashCells& to) const {
  const CellOrigin corner(parcel.beam_corner);
  for (int i = 0; i < count; ++i) {
    const std::int32_t number = buffers_.list[i];
    to.origin[i] = corner + grid.origins[static_cast<std::size_t>(number)];
    to.seed[i] = hash_cell_seed(parcel.key, static_cast<std::uint32_t>(number));
  }
}

void StickScan::scan_octave(Parcel& parcel, OctaveCells& cells, int octave) {
  const CellGrid& grid = cells.grid;
  parcel.key =
      scene_.cells.octaves[static_cast<std::size_t>(octave)].parcel_key(parcel.tissue.index);
  test_cells(grid.middles(), grid.count(), cell_test(parcel, grid, octave), buffers_.near);
  if (!parcel.straight) return take_bent_cells(parcel, cells, octave);
  take_even_cells(parcel, octave, cells);
  if (parcel.tissue.mixed != nullptr) take_mixed_cells(parcel, octave, cells);
  const std::size_t enough = parcel.bent ? 1 : kCellsTogether;
  if (cells.even.count >= enough) see_even(cells.even, grid.axes, octave);
  if (cells.mixed.count >= enough) see_mixed(cells.mixed, grid.axes, octave, parcel.direction);
}

void StickScan::see_rest() {
  for (std::size_t part = 0; part < 2; ++part) {
    for (std::size_t i = 0; i < buffers_.whole[part].size(); ++i) {
      OctaveCells& cells = buffers_.whole[part][i];
      const int octave = static_cast<int>(i);
      if (cells.even.count > 0) see_even(cells.even, cells.grid.axes, octave);
      if (cells.mixed.count > 0) {
        see_mixed(cells.mixed, cells.grid.axes, octave, direction_[part]);
      }
    }
  }
}

int StickScan::list_near(const Parcel& parcel, int octave, int count, CellKind wanted) {
  if (parcel.tissue.mixed == nullptr) return list_flags(buffers_.near, count, buffers_.list);
  // Behind an octave's cells lie the next one's, or nothing: those flags are 0.
  const CellKind* kinds = scene_.parcels.kinds(parcel.tissue, octave);
  choose_kind(buffers_.near, kinds, wanted, count, buffers_.chosen);
  return list_flags(buffers_.chosen, count, buffers_.list);
}

void StickScan::take_even_cells(const Parcel& parcel, int octave, OctaveCells& cells) {
  const TissueParcels& parcels = scene_.parcels;
  const CellGrid& grid = cells.grid;
  HashCellQueue& batch = cells.even;
  const int taken = list_near(parcel, octave, grid.count(), CellKind::even);
  const TouchedHashCells to = batch.next(static_cast<std::size_t>(taken));
  place_cells(parcel, grid, taken, to);
  if (parcel.tissue.mixed == nullptr) {
    std::fill_n(to.amplitude, taken, parcels.amplitude(parcel.tissue.material));
  } else {
    const std::int16_t* codes = parcels.codes(parcel.tissue, octave);
    for (int i = 0; i < taken; ++i) to.amplitude[i] = parcels.amplitude(codes[buffers_.list[i]]);
  }
  batch.count += static_cast<std::size_t>(taken);
}

void StickScan::take_mixed_cells(const Parcel& parcel, int octave, OctaveCells& cells) {
  const std::int16_t* codes = scene_.parcels.codes(parcel.tissue, octave);
  const CellGrid& grid = cells.grid;
  HashCellQueue& batch = cells.mixed;
  const int taken = list_near(parcel, octave, grid.count(), CellKind::mixed);
  const TouchedHashCells to = batch.next(static_cast<std::size_t>(taken));
  place_cells(parcel, grid, taken, to);
  std::fill_n(to.amplitude, taken, 1.0f);
  for (int i = 0; i < taken; ++i) {
    const MixedCell* cell = &TissueParcels::mixed_cell(parcel.tissue, codes[buffers_.list[i]]);
    __builtin_prefetch(cell);
    batch.parcels[batch.count] = parcel.tissue.mixed;
    batch.mixed[batch.count++] = cell;
  }
}

void StickScan::take_bent_cells(const Parcel& parcel, OctaveCells& cells, int octave) {
  const TissueParcels& parcels = scene_.parcels;
  const int near = list_flags(buffers_.near, cells.grid.count(), buffers_.list);
  for (int i = 0; i < near; ++i) {
    const int number = buffers_.list[i];
    const int code = parcels.code(parcel.tissue, octave, number);
    const float amplitude = code >= 0 ? parcels.amplitude(code) : 1.0f;
    if (amplitude == 0) continue;
    HashCellQueue& batch = code >= 0 ? cells.even : cells.mixed;
    const TouchedHashCells cell = batch.next(1);
    cell.seed[0] = hash_cell_seed(parcel.key, static_cast<std::uint32_t>(number));
    cell.amplitude[0] = amplitude;
    const HashAxes axes = place_bent(parcel, octave, number, cell.origin[0]);
    batch.count = 1;
    if (code >= 0) {
      see_even(batch, axes, octave);
    } else {
      batch.mixed[0] = &TissueParcels::mixed_cell(parcel.tissue, code);
      batch.parcels[0] = parcel.tissue.mixed;
      see_mixed(batch, axes, octave, parcel.direction);
    }
  }
}

HashAxes StickScan::place_bent(const Parcel& parcel,
                               int octave,
                               int number,
                               CellOrigin& origin) const {
  const int n = scene_.cells.octaves[static_cast<std::size_t>(octave)].divisions;
  const double cell_m = scene_.parcels.side_m() / n;
  const glm::dvec3 low = parcel.corner + cell_m * cell_place(number, n);
  const RestToBeam map = view_.map_near(low + 0.5 * cell_m);
  origin = cell_origin(map, low, cell_m);
  return hash_axes(map, cell_m);
}

void StickScan::see_even(HashCellQueue& batch, const HashAxes& axes, int octave) {
  EchoQueue& echoes = buffers_.echoes;
  echoes.take(see_scatterers(batch.cells(),
                             static_cast<int>(batch.count),
                             axes,
                             scene_.sight(&scene_.gains[static_cast<std::size_t>(octave)]),
                             echoes.room_for(batch.count * kScatterersInCell)));
  batch.count = 0;
}

void StickScan::see_mixed(HashCellQueue& batch,
                          const HashAxes& axes,
                          int octave,
                          const glm::vec3& direction) {
  EchoQueue& echoes = buffers_.echoes;
  const SeenScatterers seen = echoes.room_for(batch.count * kScatterersInCell);
  buffers_.hits.resize(std::max(buffers_.hits.size(), batch.count * kScatterersInCell));
  for (std::size_t i = 0; i < batch.count; ++i) {
    __builtin_prefetch(batch.parcels[i]->sheets.data() + batch.mixed[i]->first_sheet);
  }
  MixedSight mixed{batch.mixed.data(), buffers_.hits.data()};
  const int count = see_scatterers(batch.cells(),
                                   static_cast<int>(batch.count),
                                   axes,
                                   scene_.sight(&scene_.gains[static_cast<std::size_t>(octave)]),
                                   seen,
                                   &mixed);
  for (int i = 0; i < mixed.hit_count; ++i) {
    const SheetHit& hit = buffers_.hits[static_cast<std::size_t>(i)];
    const auto cell = static_cast<std::size_t>(hit.cell);
    seen.amplitude[hit.seen] *= scene_.parcels.sheet_amplitude(
        *batch.parcels[cell], *batch.mixed[cell], hit.scatterer, direction);
  }
  echoes.take(count);
  batch.count = 0;
}

}  // namespace wobblebench::sim
