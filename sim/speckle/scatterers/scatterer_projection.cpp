#include "sim/speckle/scatterers/scatterer_projection.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "sim/speckle/scatterers/scatterer_cells.h"
#include "sim/speckle/scatterers/stream_compaction.h"
#include "sim/speckle/scatterers/tissue_blocks.h"

namespace wobblebench::sim {

namespace {

WOBBLEBENCH_INLINE std::uint32_t to_index(float x) {
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(x));
}

/// A batch of hash cells and the beam at each, as a structure of arrays.
struct CellBatch {
  float axial[kCellsPerBatch];
  float lateral[kCellsPerBatch];
  float elevation[kCellsPerBatch];
  float to_center[kCellsPerBatch];
  /// HashAxes, where each cell has its own: [x, y, z][axial, lateral, elevation].
  float unit[3][3][kCellsPerBatch];
  std::uint32_t key[kCellsPerBatch];
  std::int32_t row[kCellsPerBatch];
  float lateral_columns_per_m[kCellsPerBatch];
  float elevation_columns_per_m[kCellsPerBatch];
  float delay_m[kCellsPerBatch];
  float range_scale[kCellsPerBatch];
  float lateral_tilt[kCellsPerBatch];
  float lateral_curvature_per_m[kCellsPerBatch];
  float elevation_curvature_per_m[kCellsPerBatch];
  float full[kCellsPerBatch];
  float partial[kCellsPerBatch];
  std::int32_t full_count[kCellsPerBatch];
  std::int32_t count[kCellsPerBatch];
  std::uint32_t first_table_index[kCellsPerBatch];
};

/// A multiple of kCompactionWidth. The padding cells have no contributing scatterers.
int padded(int count) {
  return (count + kCompactionWidth - 1) / kCompactionWidth * kCompactionWidth;
}

/// `count`: of the cells; those that pad the batch take the last one's.
void load_axes(const CellAxes& axes, int count, CellBatch& batch) {
  if (!axes.each) {
    std::fill_n(batch.to_center, padded(count), axes.axes->to_center);
    return;
  }
  for (int c = 0; c < padded(count); ++c) {
    const HashAxes& own = axes.axes[std::min(c, count - 1)];
    const BeamVector* const vectors[] = {&own.x, &own.y, &own.z};
    for (int axis = 0; axis < 3; ++axis) {
      batch.unit[axis][0][c] = vectors[axis]->axial;
      batch.unit[axis][1][c] = vectors[axis]->lateral;
      batch.unit[axis][2][c] = vectors[axis]->elevation;
    }
    batch.to_center[c] = own.to_center;
  }
}

/// Origins, keys and rows.
WOBBLEBENCH_SIMD void load_cells(const HashCellArrays& cells,
                                 int count,
                                 const BeamProjection& projection,
                                 CellBatch& __restrict batch) {
  // As plain floats: vector members would prevent vectorisation.
  const float* origin = reinterpret_cast<const float*>(cells.origin);
  const std::uint32_t* seed = cells.seed;
  const float rows_per_m = projection.rows_per_m;
  const std::int32_t last_row = projection.last_row;
  for (int c = 0; c < count; ++c) {
    const float* at = origin + std::ptrdiff_t{4} * c;
    const float axial = at[0];
    batch.axial[c] = axial;
    batch.lateral[c] = at[1];
    batch.elevation[c] = at[2];
    batch.key[c] = mix32(seed[c]);
    const std::int32_t row = static_cast<std::int32_t>((axial + batch.to_center[c]) * rows_per_m);
    const std::int32_t positive = row < 0 ? 0 : row;
    batch.row[c] = positive > last_row ? last_row : positive;
  }
}

/// The tables' rows of each cell, gathered by whole rows: look-ups within the loop would prevent
/// vectorisation.
struct BatchRows {
  BeamAtRow rows[kCellsPerBatch];
  OctaveAtRow octave[kCellsPerBatch];
};

/// Returns the largest number of contributing scatterers in a cell.
WOBBLEBENCH_SIMD int look_up_rows(const std::int32_t* rows,
                                  int count,
                                  const BeamProjection& projection,
                                  BatchRows& to) {
  std::int32_t most = 0;
  for (int c = 0; c < count; ++c) {
    const std::int32_t row = rows[c];
    std::memcpy(to.rows + c, projection.rows + row, sizeof(BeamAtRow));
    std::memcpy(to.octave + c, projection.octave + row, sizeof(OctaveAtRow));
    most = std::max(most, to.octave[c].count);
  }
  for (int c = count; c < padded(count); ++c) {
    to.rows[c] = {};
    to.octave[c] = {};
  }
  return most;
}

/// The beam and the amplitudes, from the cells' rows.
WOBBLEBENCH_SIMD void load_beams(const float* amplitude,
                                 int count,
                                 const BeamProjection& projection,
                                 const BatchRows& from,
                                 CellBatch& __restrict batch) {
  const float rows_per_m = projection.rows_per_m;
  const std::int32_t columns = projection.columns;
  const BeamAtRow* rows = from.rows;
  const OctaveAtRow* octave = from.octave;
  for (int c = 0; c < count; ++c) {
    const float center = batch.axial[c] + batch.to_center[c];
    const float within = within_row(center, rows_per_m, batch.row[c]);
    batch.lateral_columns_per_m[c] = rows[c].lateral_columns_at(within);
    batch.elevation_columns_per_m[c] = rows[c].elevation_columns_at(within);
    batch.delay_m[c] = rows[c].delay_m;
    batch.range_scale[c] = rows[c].range_scale;
    batch.lateral_tilt[c] = rows[c].lateral_tilt + rows[c].lateral_tilt_slope_per_m * center;
    batch.lateral_curvature_per_m[c] =
        rows[c].lateral_curvature_per_m + rows[c].lateral_curvature_slope_per_m2 * center;
    batch.elevation_curvature_per_m[c] =
        rows[c].elevation_curvature_per_m + rows[c].elevation_curvature_slope_per_m2 * center;
  }
  for (int c = 0; c < count; ++c) {
    batch.full[c] = octave[c].full * amplitude[c];
    batch.partial[c] = octave[c].partial * amplitude[c];
    batch.full_count[c] = octave[c].full_count;
    batch.count[c] = octave[c].count;
    batch.first_table_index[c] =
        rows[c].first_index +
        part_index(batch.axial[c] + batch.to_center[c], rows_per_m, batch.row[c], columns);
  }
}

/// Projects one scatterer of each cell.
template <BeamRim rim, bool own_axes>
WOBBLEBENCH_INLINE void project_cells(int count,
                                      std::int32_t scatterer,
                                      const HashAxes& axes,
                                      std::int32_t columns,
                                      const CellBatch& batch,
                                      ScattererLanes& __restrict lanes) {
  const BeamVector unit_x = axes.x, unit_y = axes.y, unit_z = axes.z;
  const auto half = static_cast<float>(columns);
  // One coordinate of a scatterer: axial, lateral or elevation.
  const auto place =
      [&](int c, int row, float origin, const CellOffset& at, float x, float y, float z) {
        return own_axes ? origin + at.x * batch.unit[0][row][c] + at.y * batch.unit[1][row][c] +
                              at.z * batch.unit[2][row][c]
                        : origin + at.x * x + at.y * y + at.z * z;
      };
  for (int c = 0; c < count; ++c) {
    const std::uint32_t bits = scatterer_bits(batch.key[c], static_cast<std::uint32_t>(scatterer));
    const CellOffset at = scatterer_offset(bits);
    const float axial = place(c, 0, batch.axial[c], at, unit_x.axial, unit_y.axial, unit_z.axial);
    const float lateral =
        place(c, 1, batch.lateral[c], at, unit_x.lateral, unit_y.lateral, unit_z.lateral);
    const float elevation =
        place(c, 2, batch.elevation[c], at, unit_x.elevation, unit_y.elevation, unit_z.elevation);
    const float u = lateral * batch.lateral_columns_per_m[c];
    const float v = magnitude(elevation) * batch.elevation_columns_per_m[c];
    lanes.range_m[c] =
        batch.delay_m[c] + batch.range_scale[c] * axial +
        (batch.lateral_tilt[c] + batch.lateral_curvature_per_m[c] * lateral) * lateral +
        batch.elevation_curvature_per_m[c] * elevation * elevation;
    lanes.table_index[c] = batch.first_table_index[c] + to_index(u + half) + (to_index(v) << 16);
    lanes.amplitude[c] =
        scatterer_sign(bits) * (scatterer < batch.full_count[c] ? batch.full[c] : batch.partial[c]);
    lanes.selected[c] = within_rim<rim>(magnitude(u), v, half) & (scatterer < batch.count[c]);
  }
}

WOBBLEBENCH_SIMD void fill_lanes(int count,
                                 int scatterer,
                                 const CellAxes& axes,
                                 const BeamProjection& projection,
                                 const CellBatch& batch,
                                 ScattererLanes& __restrict lanes) {
  const HashAxes& shared = *axes.axes;
  const std::int32_t columns = projection.columns;
  constexpr auto kEllipse = BeamRim::ellipse, kDiamond = BeamRim::diamond;
  if (projection.rim == kEllipse) {
    axes.each ? project_cells<kEllipse, true>(count, scatterer, shared, columns, batch, lanes)
              : project_cells<kEllipse, false>(count, scatterer, shared, columns, batch, lanes);
  } else {
    axes.each ? project_cells<kDiamond, true>(count, scatterer, shared, columns, batch, lanes)
              : project_cells<kDiamond, false>(count, scatterer, shared, columns, batch, lanes);
  }
}

/// Scales each lane by its scatterer's tissue. `near_interface` receives one bit a lane, 8 to a
/// byte.
void apply_tissue(const MixedCell* const* mixed,
                  int count,
                  int scatterer,
                  ScattererLanes& lanes,
                  std::uint8_t* near_interface) {
  for (int first = 0; first < kCellsPerBatch; first += 8) {
    std::uint32_t flags = 0;
    for (int c = first; c < std::min(first + 8, count); ++c) {
      const float tissue_amplitude = mixed[c]->amplitude[scatterer];
      lanes.amplitude[c] *= tissue_amplitude;
      lanes.selected[c] &= tissue_amplitude > 0.0f;
      flags |= (mixed[c]->near_interface >> scatterer & 1u) << (c - first);
    }
    near_interface[first / 8] = static_cast<std::uint8_t>(flags);
  }
}

/// Lists those of the lanes just selected that are near a rough interface. `hit`: indices of the
/// first lane, and of the first projected scatterer.
void list_interface_hits(const std::uint8_t* selected_mask,
                         const std::uint8_t* near_interface,
                         int lanes,
                         InterfaceHit hit,
                         MixedCellHits& mixed) {
  const std::int32_t first_cell = hit.cell;
  for (int group = 0; group < lanes / 8; ++group) {
    const std::uint32_t selected = selected_mask[group];
    for (std::uint32_t bits = selected & near_interface[group]; bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      mixed.hits[mixed.hit_count++] = {hit.projected + popcount16(selected & ((1u << lane) - 1)),
                                       first_cell + 8 * group + lane,
                                       hit.scatterer};
    }
    hit.projected += popcount16(selected);
  }
}

}  // namespace

int project_scatterers(const HashCellArrays& cells,
                       int count,
                       const CellAxes& axes,
                       const BeamProjection& projection,
                       const ProjectedScatterers& projected,
                       MixedCellHits* mixed) {
  int written = 0;
  BatchRows rows;
  CellBatch batch;
  ScattererLanes lanes;
  std::uint8_t selected_mask[kCellsPerBatch / 8], near_interface[kCellsPerBatch / 8];
  for (int first = 0; first < count; first += kCellsPerBatch) {
    const int batch_size = std::min(kCellsPerBatch, count - first),
              padded_count = padded(batch_size);
    const HashCellArrays these = cells.from(static_cast<std::size_t>(first));
    const CellAxes these_axes = axes.from(static_cast<std::size_t>(first));
    load_axes(these_axes, batch_size, batch);
    load_cells(these, padded_count, projection, batch);
    const int max_count = look_up_rows(batch.row, batch_size, projection, rows);
    load_beams(these.amplitude, padded_count, projection, rows, batch);
    for (int i = 0; i < max_count; ++i) {
      fill_lanes(padded_count, i, these_axes, projection, batch, lanes);
      if (mixed != nullptr)
        apply_tissue(mixed->cells + first, batch_size, i, lanes, near_interface);
      const int before = written;
      written += compact_scatterers(
          lanes, padded_count, projected.from(static_cast<std::size_t>(written)), selected_mask);
      if (mixed != nullptr)
        list_interface_hits(
            selected_mask, near_interface, padded_count, {before, first, i}, *mixed);
    }
  }
  return written;
}

int project_point(const PointScatterer& point,
                  const BeamProjection& projection,
                  const ProjectedScatterers& projected) {
  const BeamAtRow& beam = projection.rows[point.row];
  const BeamVector& at = point.at;
  const float within = within_row(at.axial, projection.rows_per_m, point.row);
  const float u = at.lateral * beam.lateral_columns_at(within);
  const auto columns = static_cast<float>(projection.columns);
  const float v = magnitude(at.elevation) * beam.elevation_columns_at(within);
  const float lateral_tilt = beam.lateral_tilt + beam.lateral_tilt_slope_per_m * at.axial;
  const float lateral_curvature =
      beam.lateral_curvature_per_m + beam.lateral_curvature_slope_per_m2 * at.axial;
  const float elevation_curvature =
      beam.elevation_curvature_per_m + beam.elevation_curvature_slope_per_m2 * at.axial;
  projected.range_m[0] = beam.delay_m + beam.range_scale * at.axial +
                         (lateral_tilt + lateral_curvature * at.lateral) * at.lateral +
                         elevation_curvature * at.elevation * at.elevation;
  projected.table_index[0] =
      beam.first_index +
      part_index(at.axial, projection.rows_per_m, point.row, projection.columns) +
      to_index(u + columns) + (to_index(v) << 16);
  projected.amplitude[0] = point.amplitude;
  return projection.rim == BeamRim::ellipse
             ? within_rim<BeamRim::ellipse>(magnitude(u), v, columns)
             : within_rim<BeamRim::diamond>(magnitude(u), v, columns);
}

}  // namespace wobblebench::sim
