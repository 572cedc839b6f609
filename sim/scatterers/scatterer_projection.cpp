#include "sim/scatterers/scatterer_projection.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace wobblebench::sim {

namespace {

/// Both places of a row's first columns are its number times the columns, times this.
constexpr std::uint32_t kBothPlaces = 0x10001;

WOBBLEBENCH_INLINE std::uint32_t whole_number(float x) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(x));
}

/// Some hash cells, and the beam there.
struct CellBeams {
  float axial[kLaneCells];
  float lateral[kLaneCells];
  float elevation[kLaneCells];
  std::uint32_t key[kLaneCells];
  std::int32_t row[kLaneCells];
  float lateral_columns_per_m[kLaneCells];
  float elevation_columns_per_m[kLaneCells];
  float late_m[kLaneCells];
  float stretch[kLaneCells];
  float lateral_bend_per_m[kLaneCells];
  float elevation_bend_per_m[kLaneCells];
  float full[kLaneCells];
  float faint[kLaneCells];
  std::int32_t in_full[kLaneCells];
  std::int32_t heard[kLaneCells];
  std::uint32_t first_places[kLaneCells];
};

/// Places and keys.
WOBBLEBENCH_SIMD void spread_cells(const TouchedHashCells& cells,
                                   int count,
                                   float to_middle,
                                   const Sight& sight,
                                   CellBeams& __restrict beams) {
  // As plain floats, or the loop stays narrow.
  const float* origin = reinterpret_cast<const float*>(cells.origin);
  const std::uint32_t* seed = cells.seed;
  const float rows_per_m = sight.rows_per_m;
  const std::int32_t last_row = sight.last_row;
  for (int c = 0; c < count; ++c) {
    const float* at = origin + std::ptrdiff_t{4} * c;
    const float axial = at[0];
    beams.axial[c] = axial;
    beams.lateral[c] = at[1];
    beams.elevation[c] = at[2];
    beams.key[c] = mix32(seed[c]);
    const std::int32_t whole = static_cast<std::int32_t>((axial + to_middle) * rows_per_m);
    const std::int32_t positive = whole < 0 ? 0 : whole;
    beams.row[c] = positive > last_row ? last_row : positive;
  }
}

/// What the tables say of each cell, moved together: loops that look it up by themselves stay
/// narrow.
struct RowLanes {
  BeamAtRow rows[kLaneCells];
  OctaveAtRow octave[kLaneCells];
};

/// Lanes that a wide loop does together; behind the last cell are some of which nothing is heard.
int whole_lanes(int count) {
  return (count + kFlagsTogether - 1) / kFlagsTogether * kFlagsTogether;
}

/// Returns how many scatterers of a cell are heard at most.
WOBBLEBENCH_SIMD int look_up_rows(const std::int32_t* rows,
                                  int count,
                                  const Sight& sight,
                                  RowLanes& to) {
  std::int32_t most = 0;
  for (int c = 0; c < count; ++c) {
    const std::int32_t row = rows[c];
    std::memcpy(to.rows + c, sight.rows + row, sizeof(BeamAtRow));
    std::memcpy(to.octave + c, sight.octave + row, sizeof(OctaveAtRow));
    most = std::max(most, to.octave[c].heard);
  }
  for (int c = count; c < whole_lanes(count); ++c) {
    to.rows[c] = {};
    to.octave[c] = {};
  }
  return most;
}

/// The beam, as their rows have it, and amplitudes.
WOBBLEBENCH_SIMD void spread_beams(const float* amplitude,
                                   int count,
                                   float to_middle,
                                   std::int32_t columns,
                                   const RowLanes& from,
                                   CellBeams& __restrict beams) {
  const BeamAtRow* rows = from.rows;
  const OctaveAtRow* octave = from.octave;
  for (int c = 0; c < count; ++c) {
    const float middle = beams.axial[c] + to_middle;
    beams.lateral_columns_per_m[c] = rows[c].lateral_columns_per_m;
    beams.elevation_columns_per_m[c] = rows[c].elevation_columns_per_m;
    beams.late_m[c] = rows[c].late_m;
    beams.stretch[c] = rows[c].stretch;
    beams.lateral_bend_per_m[c] =
        rows[c].lateral_bend_per_m + rows[c].lateral_slope_per_m2 * middle;
    beams.elevation_bend_per_m[c] =
        rows[c].elevation_bend_per_m + rows[c].elevation_slope_per_m2 * middle;
  }
  for (int c = 0; c < count; ++c) {
    beams.full[c] = octave[c].full * amplitude[c];
    beams.faint[c] = octave[c].faint * amplitude[c];
    beams.in_full[c] = octave[c].in_full;
    beams.heard[c] = octave[c].heard;
    beams.first_places[c] = static_cast<std::uint32_t>(beams.row[c] * columns) * kBothPlaces;
  }
}

/// One scatterer of each cell.
template <BeamRim rim>
WOBBLEBENCH_INLINE void see_cells(int count,
                                  std::int32_t scatterer,
                                  const HashAxes& axes,
                                  std::int32_t columns,
                                  const CellBeams& beams,
                                  ScattererLanes& __restrict lanes) {
  const HashAxes unit = axes;
  for (int c = 0; c < count; ++c) {
    const CellOffset at = scatterer_offset(beams.key[c], static_cast<std::uint32_t>(scatterer));
    const float axial =
        beams.axial[c] + at.x * unit.x.axial + at.y * unit.y.axial + at.z * unit.z.axial;
    const float lateral =
        beams.lateral[c] + at.x * unit.x.lateral + at.y * unit.y.lateral + at.z * unit.z.lateral;
    const float elevation = beams.elevation[c] + at.x * unit.x.elevation + at.y * unit.y.elevation +
                            at.z * unit.z.elevation;
    const float u = magnitude(lateral) * beams.lateral_columns_per_m[c];
    const float v = magnitude(elevation) * beams.elevation_columns_per_m[c];
    lanes.path_m[c] = beams.late_m[c] + beams.stretch[c] * axial +
                      beams.lateral_bend_per_m[c] * lateral * lateral +
                      beams.elevation_bend_per_m[c] * elevation * elevation;
    lanes.places[c] = beams.first_places[c] + whole_number(u) + (whole_number(v) << 16);
    lanes.amplitude[c] = scatterer < beams.in_full[c] ? beams.full[c] : beams.faint[c];
    lanes.within[c] =
        within_rim<rim>(u, v, static_cast<float>(columns)) & (scatterer < beams.heard[c]);
  }
}

WOBBLEBENCH_SIMD void fill_lanes(int count,
                                 int scatterer,
                                 const HashAxes& axes,
                                 const Sight& sight,
                                 const CellBeams& beams,
                                 ScattererLanes& __restrict lanes) {
  if (sight.rim == BeamRim::ellipse) {
    see_cells<BeamRim::ellipse>(count, scatterer, axes, sight.columns, beams, lanes);
  } else {
    see_cells<BeamRim::diamond>(count, scatterer, axes, sight.columns, beams, lanes);
  }
}

/// Gives each lane its own tissue; `in_sheet` gets which of them lie in sheets, 8 to a byte.
void weigh_lanes(const MixedCell* const* mixed,
                 int count,
                 int scatterer,
                 ScattererLanes& lanes,
                 std::uint8_t* in_sheet) {
  for (int first = 0; first < kLaneCells; first += 8) {
    std::uint32_t flags = 0;
    for (int c = first; c < std::min(first + 8, count); ++c) {
      const float strength = mixed[c]->amplitude[scatterer];
      lanes.amplitude[c] *= strength;
      lanes.within[c] &= strength > 0.0f;
      flags |= (mixed[c]->in_sheet >> scatterer & 1u) << (c - first);
    }
    in_sheet[first / 8] = static_cast<std::uint8_t>(flags);
  }
}

/// Writes those of the lanes that were packed last that lie in sheets. `hit`: of the first of them.
void list_hits(const std::uint8_t* which,
               const std::uint8_t* in_sheet,
               int lanes,
               SheetHit hit,
               MixedSight& mixed) {
  const std::int32_t first_cell = hit.cell;
  for (int group = 0; group < lanes / 8; ++group) {
    const std::uint32_t within = which[group];
    for (std::uint32_t left = within & in_sheet[group]; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      mixed.hits[mixed.hit_count++] = {hit.seen + flags_set(within & ((1u << lane) - 1)),
                                       first_cell + 8 * group + lane,
                                       hit.scatterer};
    }
    hit.seen += flags_set(within);
  }
}

}  // namespace

int see_scatterers(const TouchedHashCells& cells,
                   int count,
                   const HashAxes& axes,
                   const Sight& sight,
                   const SeenScatterers& seen,
                   MixedSight* mixed) {
  int kept = 0;
  RowLanes rows;
  CellBeams beams;
  ScattererLanes lanes;
  std::uint8_t which[kLaneCells / 8], in_sheet[kLaneCells / 8];
  for (int first = 0; first < count; first += kLaneCells) {
    const int some = std::min(kLaneCells, count - first), whole = whole_lanes(some);
    const TouchedHashCells here = cells.from(static_cast<std::size_t>(first));
    spread_cells(here, whole, axes.to_middle, sight, beams);
    const int heard = look_up_rows(beams.row, some, sight, rows);
    spread_beams(here.amplitude, whole, axes.to_middle, sight.columns, rows, beams);
    for (int i = 0; i < heard; ++i) {
      fill_lanes(whole, i, axes, sight, beams, lanes);
      if (mixed != nullptr) weigh_lanes(mixed->cells + first, some, i, lanes, in_sheet);
      const int before = kept;
      kept += pack_lanes(lanes, whole, seen.from(static_cast<std::size_t>(kept)), which);
      if (mixed != nullptr) list_hits(which, in_sheet, whole, {before, first, i}, *mixed);
    }
  }
  return kept;
}

int see_place(const BeamPlace& place, const Sight& sight, const SeenScatterers& seen) {
  const BeamAtRow& beam = sight.rows[place.row];
  const BeamVector& at = place.at;
  const float u = magnitude(at.lateral) * beam.lateral_columns_per_m;
  const float v = magnitude(at.elevation) * beam.elevation_columns_per_m;
  const float lateral_bend = beam.lateral_bend_per_m + beam.lateral_slope_per_m2 * at.axial;
  const float elevation_bend = beam.elevation_bend_per_m + beam.elevation_slope_per_m2 * at.axial;
  seen.path_m[0] = beam.late_m + beam.stretch * at.axial + lateral_bend * at.lateral * at.lateral +
                   elevation_bend * at.elevation * at.elevation;
  seen.places[0] = static_cast<std::uint32_t>(place.row * sight.columns) * kBothPlaces +
                   whole_number(u) + (whole_number(v) << 16);
  seen.amplitude[0] = place.amplitude;
  const float columns = static_cast<float>(sight.columns);
  return sight.rim == BeamRim::ellipse ? within_rim<BeamRim::ellipse>(u, v, columns)
                                       : within_rim<BeamRim::diamond>(u, v, columns);
}

}  // namespace wobblebench::sim
