#include "sim/scatterer_kernels.h"

#include <algorithm>
#include <bit>
#include <cstring>

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

WOBBLEBENCH_INLINE BeamVector place(const BeamVector& corner,
                                    const HashAxes& axes,
                                    const CellOffset& at) {
  return {corner.axial + at.x * axes.x.axial + at.y * axes.y.axial + at.z * axes.z.axial,
          corner.lateral + at.x * axes.x.lateral + at.y * axes.y.lateral + at.z * axes.z.lateral,
          corner.elevation + at.x * axes.x.elevation + at.y * axes.y.elevation +
              at.z * axes.z.elevation};
}

/// How far beyond the rim a place is, in squared columns or columns; negative: within.
template <BeamRim rim>
WOBBLEBENCH_INLINE float beyond_rim(float u, float v, float columns) {
  return rim == BeamRim::ellipse ? u * u + v * v - columns * columns : u + v - columns;
}

/// One place in the beam.
struct Seen {
  float path_m;
  std::int32_t entry;
  std::int32_t within;
};

template <BeamRim rim>
WOBBLEBENCH_INLINE Seen
look(const BeamVector& at, const BeamAtRow& beam, std::int32_t row, std::int32_t columns) {
  const float u = magnitude(at.lateral) * beam.lateral_columns_per_m;
  const float v = magnitude(at.elevation) * beam.elevation_columns_per_m;
  const float late = beam.late_m + beam.late_slope * at.axial;
  const float lateral_bend = beam.lateral_bend_per_m + beam.lateral_slope_per_m2 * at.axial;
  const float elevation_bend = beam.elevation_bend_per_m + beam.elevation_slope_per_m2 * at.axial;
  const std::int32_t place = row * columns + static_cast<std::int32_t>(u);
  return {at.axial + late + lateral_bend * at.lateral * at.lateral +
              elevation_bend * at.elevation * at.elevation,
          place * columns + static_cast<std::int32_t>(v),
          (beyond_rim<rim>(u, v, static_cast<float>(columns)) < 0.0f) & (at.axial > 0.0f)};
}

template <BeamRim rim>
WOBBLEBENCH_INLINE void fill_cells(const TouchedHashCells& cells,
                                   int count,
                                   const HashAxes& axes,
                                   const Sight& sight,
                                   CellLanes& __restrict lanes) {
  for (int c = 0; c < count; ++c) {
    const BeamVector corner{cells.axial[c], cells.lateral[c], cells.elevation[c]};
    const std::int32_t row = cells.row[c];
    const std::uint32_t key = cells.key[c];
    const float strength = cells.amplitude[c];
    const float* gain = sight.gain + static_cast<std::ptrdiff_t>(row) * kScatterersInCell;
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(c) * kScatterersInCell;
    float* path_m = lanes.path_m + first;
    std::int32_t* entry = lanes.entry + first;
    float* amplitude = lanes.amplitude + first;
    std::int32_t* within = lanes.within + first;
    for (int i = 0; i < kScatterersInCell; ++i) {
      const CellOffset offset = scatterer_offset(key, static_cast<std::uint32_t>(i));
      const Seen seen = look<rim>(place(corner, axes, offset), sight.rows[row], row, sight.columns);
      path_m[i] = seen.path_m;
      entry[i] = seen.entry;
      amplitude[i] = strength * gain[i];
      within[i] = seen.within & (gain[i] > 0.0f);
    }
  }
}

WOBBLEBENCH_SIMD void fill_lanes(const TouchedHashCells& cells,
                                 int count,
                                 const HashAxes& axes,
                                 const Sight& sight,
                                 CellLanes& lanes) {
  if (sight.rim == BeamRim::ellipse) {
    fill_cells<BeamRim::ellipse>(cells, count, axes, sight, lanes);
  } else {
    fill_cells<BeamRim::diamond>(cells, count, axes, sight, lanes);
  }
}

/// Gives each lane its own tissue.
WOBBLEBENCH_SIMD void weigh_lanes(const MixedCell* const* mixed, int count, CellLanes& lanes) {
  for (int c = 0; c < count; ++c) {
    const float* strength = mixed[c]->amplitude;
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(c) * kScatterersInCell;
    float* amplitude = lanes.amplitude + first;
    std::int32_t* within = lanes.within + first;
    for (int i = 0; i < kScatterersInCell; ++i) {
      amplitude[i] *= strength[i];
      within[i] &= strength[i] > 0.0f;
    }
  }
}

WOBBLEBENCH_INLINE float reach_at(const ReachAlong& reach, float axial) {
  return reach.at + axial * (reach.slope + reach.square * axial);
}

template <BeamRim rim>
WOBBLEBENCH_INLINE void test_within(const CellPlaces& places,
                                    int count,
                                    const CellTest& test,
                                    TestedCells& __restrict tested) {
  const BeamVector corner = test.corner, half_cell = test.half_cell;
  const ParcelReach reach = test.reach;
  const float rows_per_m = test.rows_per_m;
  const std::int32_t last_row = test.last_row;
  const std::int32_t first_heard = test.first_heard, last_heard = test.last_heard;
  const std::uint32_t parcel_key = test.parcel_key;
  for (int i = 0; i < count; ++i) {
    const float axial = corner.axial + places.axial[i];
    const float wide = reach_at(reach.lateral_m, axial);
    const float high = reach_at(reach.elevation_m, axial);
    // The cell's nearest place to the axis, at least; over the reach in both directions, but
    // without dividing.
    const float lateral = magnitude(corner.lateral + places.lateral[i]) - half_cell.lateral;
    const float elevation = magnitude(corner.elevation + places.elevation[i]) - half_cell.elevation;
    const float u = (lateral > 0.0f ? lateral : 0.0f) * high;
    const float v = (elevation > 0.0f ? elevation : 0.0f) * wide;
    const std::int32_t whole = static_cast<std::int32_t>(axial * rows_per_m);
    const std::int32_t positive = whole < 0 ? 0 : whole;
    const std::int32_t row = positive > last_row ? last_row : positive;
    tested.axial[i] = corner.axial + places.corner_axial[i];
    tested.lateral[i] = corner.lateral + places.corner_lateral[i];
    tested.elevation[i] = corner.elevation + places.corner_elevation[i];
    tested.key[i] = hash_cell_key(parcel_key, static_cast<std::uint32_t>(i));
    tested.row[i] = row;
    tested.near[i] =
        (beyond_rim<rim>(u, v, wide * high) < 0.0f) & (row >= first_heard) & (row <= last_heard);
  }
}

}  // namespace

int see_scatterers(const TouchedHashCells& cells,
                   int count,
                   const HashAxes& axes,
                   const Sight& sight,
                   const SeenScatterers& seen) {
  int kept = 0;
  CellLanes lanes;
  std::uint8_t which[kLaneCells];
  for (int first = 0; first < count; first += kLaneCells) {
    const int some = std::min(kLaneCells, count - first);
    fill_lanes(cells.from(static_cast<std::size_t>(first)), some, axes, sight, lanes);
    kept += pack_lanes(lanes, some, seen.from(static_cast<std::size_t>(kept)), which);
  }
  return kept;
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
    seen.amplitude[kept] = place.amplitude * beam.scale;
    kept += found.within;
  }
  return kept;
}

int see_mixed_scatterers(const TouchedHashCells& cells,
                         const MixedCell* const* mixed,
                         int count,
                         const HashAxes& axes,
                         const Sight& sight,
                         const SeenScatterers& seen,
                         SheetHit* hits,
                         int* hit_count) {
  int kept = 0, hit = 0;
  CellLanes lanes;
  std::uint8_t which[kLaneCells];
  for (int first = 0; first < count; first += kLaneCells) {
    const int some = std::min(kLaneCells, count - first);
    fill_lanes(cells.from(static_cast<std::size_t>(first)), some, axes, sight, lanes);
    weigh_lanes(mixed + first, some, lanes);
    int at = kept;
    kept += pack_lanes(lanes, some, seen.from(static_cast<std::size_t>(kept)), which);
    for (int c = 0; c < some; ++c) {
      const std::uint32_t within = which[c];
      for (std::uint32_t left = within & mixed[first + c]->in_sheet; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        hits[hit++] = {at + flags_set(within & ((1u << i) - 1)), first + c, i};
      }
      at += flags_set(within);
    }
  }
  *hit_count = hit;
  return kept;
}

WOBBLEBENCH_SIMD void test_cells(const CellPlaces& places,
                                 int count,
                                 const CellTest& test,
                                 TestedCells& tested) {
  if (test.rim == BeamRim::ellipse) {
    test_within<BeamRim::ellipse>(places, count, test, tested);
  } else {
    test_within<BeamRim::diamond>(places, count, test, tested);
  }
}

WOBBLEBENCH_SIMD void choose_kind(const std::uint8_t* near,
                                  const CellKind* kinds,
                                  CellKind wanted,
                                  int count,
                                  std::uint8_t* __restrict chosen) {
  for (int i = 0; i < count; ++i) {
    chosen[i] = static_cast<std::uint8_t>(near[i] & static_cast<std::uint8_t>(kinds[i] == wanted));
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

/// Two 16-bit fractions, the real part in the low half.
WOBBLEBENCH_INLINE Complex unpacked(std::uint32_t word) {
  return {static_cast<float>(static_cast<std::int32_t>(word << 16) >> 16),
          static_cast<float>(static_cast<std::int32_t>(word) >> 16)};
}

/// What the beam's sections say of each, moved together: loops that look them up by themselves
/// stay narrow.
struct SectionLanes {
  struct Words {
    std::uint32_t level;
    std::uint32_t colour;
  };
  Words words[kEchoBatch];
};

void look_up(const std::uint32_t* beam, const std::int32_t* entries, int count, SectionLanes& to) {
  for (int i = 0; i < count; ++i) {
    std::memcpy(
        to.words + i, beam + 2 * static_cast<std::ptrdiff_t>(entries[i]), sizeof to.words[i]);
  }
}

WOBBLEBENCH_INLINE void echo_lanes(const SeenScatterers& seen,
                                   const SectionLanes& sections,
                                   int count,
                                   const EchoConstants& constants,
                                   EchoLanes& __restrict lanes,
                                   std::int32_t* __restrict bins) {
  const SectionLanes::Words* words = sections.words;
  const float* paths = seen.path_m;
  const float* amplitudes = seen.amplitude;
  const float cycles_per_m = constants.cycles_per_m, bins_per_m = constants.bins_per_m;
  const float colour_per_bin = constants.colour_per_bin;
  const std::int32_t last_bin = constants.last_bin;
  for (int i = 0; i < count; ++i) {
    const float path = paths[i], amplitude = amplitudes[i];
    const Complex level = unpacked(words[i].level), colour = unpacked(words[i].colour);
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

WOBBLEBENCH_SIMD void shape_echoes(const SeenScatterers& seen,
                                   const SectionLanes& sections,
                                   int count,
                                   const EchoConstants& constants,
                                   BinShare* __restrict shares,
                                   std::int32_t* __restrict bins) {
  EchoLanes lanes;
  echo_lanes(seen, sections, count, constants, lanes, bins);
  for (int i = 0; i < count; ++i) {
    shares[i] = {lanes.low_re[i], lanes.low_im[i], lanes.high_re[i], lanes.high_im[i]};
  }
}

}  // namespace

void make_echoes(const SeenScatterers& seen,
                 int count,
                 const EchoConstants& constants,
                 BinShare* shares,
                 std::int32_t* bins) {
  SectionLanes sections;
  look_up(constants.beam, seen.entry, count, sections);
  shape_echoes(seen, sections, count, constants, shares, bins);
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
