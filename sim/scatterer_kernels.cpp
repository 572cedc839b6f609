#include "sim/scatterer_kernels.h"

#include "sim/fast_math.h"

namespace wobblebench::sim {

namespace {

WOBBLEBENCH_INLINE float magnitude(float x) {
  return x < 0.0f ? -x : x;
}

/// std::complex checks for infinities, which keeps loops narrow.
struct Complex {
  float re;
  float im;
};

WOBBLEBENCH_INLINE Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

WOBBLEBENCH_INLINE Complex operator+(const Complex& a, const Complex& b) {
  return {a.re + b.re, a.im + b.im};
}

WOBBLEBENCH_INLINE BeamVector place(const TouchedHashCell& cell,
                                    const HashAxes& axes,
                                    const CellOffset& at) {
  return {
      cell.corner.axial + at.x * axes.x.axial + at.y * axes.y.axial + at.z * axes.z.axial,
      cell.corner.lateral + at.x * axes.x.lateral + at.y * axes.y.lateral + at.z * axes.z.lateral,
      cell.corner.elevation + at.x * axes.x.elevation + at.y * axes.y.elevation +
          at.z * axes.z.elevation};
}

/// One block of a cell's scatterers, seen or not.
struct Lanes {
  float path_m[kScattererLanes];
  std::uint32_t entry[kScattererLanes];
  std::int32_t within[kScattererLanes];
  float amplitude[kScattererLanes];
  std::int32_t in_sheet[kScattererLanes];
};

/// How far beyond the rim a place is, in squared columns or columns; negative: within.
template <BeamRim rim>
WOBBLEBENCH_INLINE float beyond_rim(float u, float v, float columns) {
  return rim == BeamRim::ellipse ? u * u + v * v - columns * columns : u + v - columns;
}

/// One place in the beam.
struct Seen {
  float path_m;
  std::uint32_t entry;
  std::int32_t within;
};

template <BeamRim rim>
WOBBLEBENCH_INLINE Seen
look(const BeamVector& at, const BeamAtRow& beam, std::int32_t row, float columns) {
  const float u = magnitude(at.lateral) * beam.lateral_columns_per_m;
  const float v = magnitude(at.elevation) * beam.elevation_columns_per_m;
  const float lateral_bend = beam.lateral_bend_per_m + beam.lateral_slope_per_m2 * at.axial;
  const float elevation_bend = beam.elevation_bend_per_m + beam.elevation_slope_per_m2 * at.axial;
  const float late = beam.late_m + beam.late_slope * at.axial;
  return {at.axial + late + lateral_bend * at.lateral * at.lateral +
              elevation_bend * at.elevation * at.elevation,
          pack_entry(static_cast<std::uint32_t>(row),
                     static_cast<std::int32_t>(u),
                     static_cast<std::int32_t>(v)),
          (beyond_rim<rim>(u, v, columns) < 0.0f) & (at.axial > 0.0f)};
}

WOBBLEBENCH_INLINE float distance_to(const SurfacePatch& p, const CellOffset& at) {
  constexpr float kX = static_cast<float>(2 / kHashUnits[0]);
  constexpr float kY = static_cast<float>(2 / kHashUnits[1]);
  constexpr float kZ = static_cast<float>(2 / kHashUnits[2]);
  const float x = at.x * kX - 1.0f, y = at.y * kY - 1.0f, z = at.z * kZ - 1.0f;
  return p.at + x * (p.bx + p.qxx * x + p.qxy * y) + y * (p.by + p.qyy * y + p.qyz * z) +
         z * (p.bz + p.qzz * z + p.qxz * x);
}

template <BeamRim rim, bool cut>
WOBBLEBENCH_INLINE void fill_lanes(const TouchedHashCell& cell,
                                   const BeamAtRow& beam,
                                   std::uint32_t first,
                                   const HashAxes& axes,
                                   float columns,
                                   const SurfacePatch& patch,
                                   float half_sheet_m,
                                   Lanes& lanes) {
  const float inside = patch.inside_amplitude, outside = patch.outside_amplitude;
  for (int i = 0; i < kScattererLanes; ++i) {
    const CellOffset offset = scatterer_offset(cell.key, first + static_cast<std::uint32_t>(i));
    const Seen seen = look<rim>(place(cell, axes, offset), beam, cell.row, columns);
    lanes.path_m[i] = seen.path_m;
    lanes.entry[i] = seen.entry;
    std::int32_t within = seen.within;
    if constexpr (cut) {
      const float distance = distance_to(patch, offset);
      const float side = distance < 0.0f ? inside : outside;
      const std::int32_t in_sheet = magnitude(distance) < half_sheet_m;
      within &= in_sheet | (side > 0.0f);
      lanes.amplitude[i] = cell.amplitude * side;
      lanes.in_sheet[i] = in_sheet & within;
    }
    lanes.within[i] = within;
  }
}

template <BeamRim rim, bool numbered>
WOBBLEBENCH_INLINE int see(const TouchedHashCell* cells,
                           int count,
                           const HashAxes& axes,
                           const Sight& sight,
                           const SeenScatterers& seen,
                           std::int32_t* numbers) {
  int kept = 0;
  Lanes lanes;
  for (int c = 0; c < count; ++c) {
    const TouchedHashCell& cell = cells[c];
    const BeamAtRow& beam = sight.rows[cell.row];
    for (int first = 0; first < cell.count; first += kScattererLanes) {
      fill_lanes<rim, false>(
          cell, beam, static_cast<std::uint32_t>(first), axes, sight.columns, {}, 0.0f, lanes);
      const int left = cell.count - first;
      const int used = left < kScattererLanes ? left : kScattererLanes;
#pragma GCC unroll 1  // unrolled, it takes the lanes apart one by one
      for (int i = 0; i < used; ++i) {
        seen.path_m[kept] = lanes.path_m[i];
        seen.entry[kept] = lanes.entry[i];
        seen.amplitude[kept] = cell.amplitude;
        if (numbered) numbers[kept] = first + i;
        kept += lanes.within[i];
      }
    }
  }
  return kept;
}

template <BeamRim rim>
WOBBLEBENCH_INLINE int see_cut(const TouchedHashCell* cells,
                               const SurfacePatch* const* patches,
                               int count,
                               const HashAxes& axes,
                               const Sight& sight,
                               float half_sheet_m,
                               const SeenScatterers& seen,
                               SheetHit* hits,
                               int* hit_count) {
  int kept = 0, hit = 0;
  Lanes lanes;
  for (int c = 0; c < count; ++c) {
    const TouchedHashCell& cell = cells[c];
    const BeamAtRow& beam = sight.rows[cell.row];
    for (int first = 0; first < cell.count; first += kScattererLanes) {
      fill_lanes<rim, true>(cell,
                            beam,
                            static_cast<std::uint32_t>(first),
                            axes,
                            sight.columns,
                            *patches[c],
                            half_sheet_m,
                            lanes);
      const int left = cell.count - first;
      const int used = left < kScattererLanes ? left : kScattererLanes;
#pragma GCC unroll 1
      for (int i = 0; i < used; ++i) {
        seen.path_m[kept] = lanes.path_m[i];
        seen.entry[kept] = lanes.entry[i];
        seen.amplitude[kept] = lanes.amplitude[i];
        hits[hit] = {kept, c, first + i};
        hit += lanes.in_sheet[i];
        kept += lanes.within[i];
      }
    }
  }
  *hit_count = hit;
  return kept;
}

WOBBLEBENCH_SIMD int see_even(const TouchedHashCell* cells,
                              int count,
                              const HashAxes& axes,
                              const Sight& sight,
                              const SeenScatterers& seen) {
  return sight.rim == BeamRim::ellipse
             ? see<BeamRim::ellipse, false>(cells, count, axes, sight, seen, nullptr)
             : see<BeamRim::diamond, false>(cells, count, axes, sight, seen, nullptr);
}

WOBBLEBENCH_SIMD int see_numbered(const TouchedHashCell* cells,
                                  int count,
                                  const HashAxes& axes,
                                  const Sight& sight,
                                  const SeenScatterers& seen,
                                  std::int32_t* numbers) {
  return sight.rim == BeamRim::ellipse
             ? see<BeamRim::ellipse, true>(cells, count, axes, sight, seen, numbers)
             : see<BeamRim::diamond, true>(cells, count, axes, sight, seen, numbers);
}

WOBBLEBENCH_INLINE float reach_at(const ReachAlong& reach, float axial) {
  return reach.at + axial * (reach.slope + reach.square * axial);
}

template <BeamRim rim>
WOBBLEBENCH_INLINE void find_near(const HashCellCenters& centers,
                                  int count,
                                  const BeamVector& corner,
                                  const BeamVector& half_cell,
                                  const ParcelReach& reach,
                                  std::uint32_t parcel_key,
                                  std::uint32_t first_number,
                                  std::uint32_t* __restrict keys,
                                  std::uint8_t* __restrict near) {
  for (int i = 0; i < count; ++i) {
    const float axial = corner.axial + centers.axial[i];
    const float wide = reach_at(reach.lateral_m, axial);
    const float high = reach_at(reach.elevation_m, axial);
    // The cell's nearest place to the axis, at least; over the reach in both directions, but
    // without dividing.
    const float lateral = magnitude(corner.lateral + centers.lateral[i]) - half_cell.lateral;
    const float elevation =
        magnitude(corner.elevation + centers.elevation[i]) - half_cell.elevation;
    const float u = (lateral > 0.0f ? lateral : 0.0f) * high;
    const float v = (elevation > 0.0f ? elevation : 0.0f) * wide;
    near[i] = beyond_rim<rim>(u, v, wide * high) < 0.0f ? 1 : 0;
    keys[i] = hash_cell_key(parcel_key, first_number + static_cast<std::uint32_t>(i));
  }
}

}  // namespace

int see_scatterers(const TouchedHashCell* cells,
                   int count,
                   const HashAxes& axes,
                   const Sight& sight,
                   const SeenScatterers& seen,
                   std::int32_t* numbers) {
  return numbers == nullptr ? see_even(cells, count, axes, sight, seen)
                            : see_numbered(cells, count, axes, sight, seen, numbers);
}

int see_places(const BeamPlace* places, int count, const Sight& sight, const SeenScatterers& seen) {
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    const BeamPlace& place = places[i];
    const BeamAtRow& beam = sight.rows[place.row];
    const Seen found = sight.rim == BeamRim::ellipse
                           ? look<BeamRim::ellipse>(place.at, beam, place.row, sight.columns)
                           : look<BeamRim::diamond>(place.at, beam, place.row, sight.columns);
    seen.path_m[kept] = found.path_m;
    seen.entry[kept] = found.entry;
    seen.amplitude[kept] = place.amplitude;
    kept += found.within;
  }
  return kept;
}

WOBBLEBENCH_SIMD int see_cut_scatterers(const TouchedHashCell* cells,
                                        const SurfacePatch* const* patches,
                                        int count,
                                        const HashAxes& axes,
                                        const Sight& sight,
                                        float half_sheet_m,
                                        const SeenScatterers& seen,
                                        SheetHit* hits,
                                        int* hit_count) {
  return sight.rim == BeamRim::ellipse
             ? see_cut<BeamRim::ellipse>(
                   cells, patches, count, axes, sight, half_sheet_m, seen, hits, hit_count)
             : see_cut<BeamRim::diamond>(
                   cells, patches, count, axes, sight, half_sheet_m, seen, hits, hit_count);
}

WOBBLEBENCH_SIMD void find_near_cells(const HashCellCenters& centers,
                                      int count,
                                      const BeamVector& corner,
                                      const BeamVector& half_cell,
                                      const ParcelReach& reach,
                                      BeamRim rim,
                                      std::uint32_t parcel_key,
                                      std::uint32_t first_number,
                                      std::uint32_t* keys,
                                      std::uint8_t* near) {
  if (rim == BeamRim::ellipse) {
    find_near<BeamRim::ellipse>(
        centers, count, corner, half_cell, reach, parcel_key, first_number, keys, near);
  } else {
    find_near<BeamRim::diamond>(
        centers, count, corner, half_cell, reach, parcel_key, first_number, keys, near);
  }
}

namespace {

/// Echoes before they are put side by side for the bins.
struct EchoLanes {
  float low_re[kEchoBatch];
  float low_im[kEchoBatch];
  float high_re[kEchoBatch];
  float high_im[kEchoBatch];
};

WOBBLEBENCH_INLINE void echo_lanes(const SeenScatterers& seen,
                                   int count,
                                   const EchoConstants& constants,
                                   EchoLanes& __restrict lanes,
                                   std::int32_t* __restrict bins) {
  const float* lateral = constants.lateral;
  const float* elevation = constants.elevation;
  const float* paths = seen.path_m;
  const std::uint32_t* entries = seen.entry;
  const float* amplitudes = seen.amplitude;
  const float cycles_per_m = constants.cycles_per_m, bins_per_m = constants.bins_per_m;
  const float colour_per_bin = constants.colour_per_bin;
  const std::int32_t last_bin = constants.last_bin, columns = constants.columns;
  constexpr std::int32_t kColumn = (1 << kColumnBits) - 1;
  for (int i = 0; i < count; ++i) {
    const float path = paths[i], amplitude = amplitudes[i];
    const std::int32_t entry = static_cast<std::int32_t>(entries[i]);
    const std::int32_t row = (entry >> (2 * kColumnBits)) * columns;
    const std::int32_t at_l = 4 * (row + ((entry >> kColumnBits) & kColumn));
    const std::int32_t at_e = 4 * (row + (entry & kColumn));
    const Complex level_l{lateral[at_l], lateral[at_l + 1]};
    const Complex colour_l{lateral[at_l + 2], lateral[at_l + 3]};
    const Complex level_e{elevation[at_e], elevation[at_e + 1]};
    const Complex colour_e{elevation[at_e + 2], elevation[at_e + 3]};
    const Complex level = level_l * level_e;
    const Complex colour = level_l * colour_e + colour_l * level_e;

    const float cycles = path * cycles_per_m;
    const CosSin angle =
        cos_sin_of_cycles(static_cast<float>(static_cast<std::int32_t>(cycles)) - cycles);
    const Complex turn{amplitude * angle.cosine, amplitude * angle.sine};
    const float position = path * bins_per_m + 1.0f;
    const std::int32_t whole = static_cast<std::int32_t>(position);
    const std::int32_t positive = whole < 0 ? 0 : whole;
    const std::int32_t bin = positive > last_bin ? last_bin : positive;
    const float high = position - static_cast<float>(bin);
    const Complex echo = level * turn;
    const Complex dark = colour * turn;
    // The pulse's derivative, p' B / (2 i k0), as the difference of the bin's two ends.
    const Complex slope{colour_per_bin * dark.im, -colour_per_bin * dark.re};
    const Complex far{high * echo.re - slope.re, high * echo.im - slope.im};
    lanes.low_re[i] = echo.re - far.re;
    lanes.low_im[i] = echo.im - far.im;
    lanes.high_re[i] = far.re;
    lanes.high_im[i] = far.im;
    bins[i] = bin;
  }
}

}  // namespace

WOBBLEBENCH_SIMD void make_echoes(const SeenScatterers& seen,
                                  int count,
                                  const EchoConstants& constants,
                                  BinShare* __restrict shares,
                                  std::int32_t* __restrict bins) {
  EchoLanes lanes;
  echo_lanes(seen, count, constants, lanes, bins);
  for (int i = 0; i < count; ++i) {
    shares[i] = {lanes.low_re[i], lanes.low_im[i], lanes.high_re[i], lanes.high_im[i]};
  }
}

void deposit(const BinShare* shares, const std::int32_t* at, int count, BinShare* bins) {
  for (int i = 0; i < count; ++i) {
    BinShare& bin = bins[at[i]];
    bin.low_re += shares[i].low_re;
    bin.low_im += shares[i].low_im;
    bin.high_re += shares[i].high_re;
    bin.high_im += shares[i].high_im;
  }
}

WOBBLEBENCH_SIMD void smooth(
    const float* values, const float* taps, int tap_count, int count, float* __restrict sums) {
  for (int t = 0; t < tap_count; ++t) {
    const float tap = taps[t];
    const float* from = values + t;
    for (int m = 0; m < count; ++m) sums[m] += tap * from[m];
  }
}

}  // namespace wobblebench::sim
