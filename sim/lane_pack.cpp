#include "sim/lane_pack.h"

#include <bit>
#include <cstddef>

#include "sim/simd.h"

#if WOBBLEBENCH_HAND_SIMD
#include <immintrin.h>
#endif

namespace wobblebench::sim {

namespace {

using PackLanes = int (*)(const CellLanes&, int, const SeenScatterers&, std::uint8_t*);
using PackCells = int (*)(const TestedCells&, const std::uint8_t*, int, const TouchedHashCells&);
using ListFlags = int (*)(const std::uint8_t*, int, std::int32_t*);

int pack_one_by_one(const CellLanes& lanes,
                    int cells,
                    const SeenScatterers& to,
                    std::uint8_t* which) {
  int kept = 0;
  for (int cell = 0; cell < cells; ++cell) {
    std::uint32_t mask = 0;
    for (int i = 0; i < kScatterersInCell; ++i) {
      const int lane = cell * kScatterersInCell + i;
      to.path_m[kept] = lanes.path_m[lane];
      to.entry[kept] = lanes.entry[lane];
      to.amplitude[kept] = lanes.amplitude[lane];
      kept += lanes.within[lane];
      mask |= static_cast<std::uint32_t>(lanes.within[lane]) << i;
    }
    which[cell] = static_cast<std::uint8_t>(mask);
  }
  return kept;
}

int pack_cells_one_by_one(const TestedCells& cells,
                          const std::uint8_t* flags,
                          int count,
                          const TouchedHashCells& to) {
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    to.axial[kept] = cells.axial[i];
    to.lateral[kept] = cells.lateral[i];
    to.elevation[kept] = cells.elevation[i];
    to.key[kept] = cells.key[i];
    to.row[kept] = cells.row[i];
    kept += flags[i];
  }
  return kept;
}

int list_one_by_one(const std::uint8_t* flags, int count, std::int32_t* list) {
  int listed = 0;
  for (int i = 0; i < count; ++i) {
    list[listed] = i;
    listed += flags[i];
  }
  return listed;
}

#if WOBBLEBENCH_HAND_SIMD
#define WOBBLEBENCH_AVX512 __attribute__((target("avx512f,avx512vl,avx512bw,popcnt")))

WOBBLEBENCH_AVX512 int pack_at_once(const CellLanes& lanes,
                                    int cells,
                                    const SeenScatterers& to,
                                    std::uint8_t* which) {
  static_assert(kScatterersInCell == 8);
  const auto load = [](const auto* from) WOBBLEBENCH_AVX512 {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  };
  const auto store = [](auto* at, __m256i value) WOBBLEBENCH_AVX512 {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(at), value);
  };
  int kept = 0;
  for (int cell = 0; cell < cells; ++cell) {
    const std::ptrdiff_t lane = static_cast<std::ptrdiff_t>(cell) * kScatterersInCell;
    const __m256i within = load(lanes.within + lane);
    const __mmask8 mask = _mm256_test_epi32_mask(within, within);
    store(to.path_m + kept, _mm256_maskz_compress_epi32(mask, load(lanes.path_m + lane)));
    store(to.entry + kept, _mm256_maskz_compress_epi32(mask, load(lanes.entry + lane)));
    store(to.amplitude + kept, _mm256_maskz_compress_epi32(mask, load(lanes.amplitude + lane)));
    which[cell] = mask;
    kept += std::popcount(static_cast<std::uint32_t>(mask));
  }
  return kept;
}

WOBBLEBENCH_AVX512 int pack_cells_at_once(const TestedCells& cells,
                                          const std::uint8_t* flags,
                                          int count,
                                          const TouchedHashCells& to) {
  static_assert(kFlagsTogether == 16);
  int kept = 0;
  for (int i = 0; i < count; i += kFlagsTogether) {
    const __m128i here = _mm_loadu_si128(reinterpret_cast<const __m128i*>(flags + i));
    const __mmask16 mask = _mm_test_epi8_mask(here, here);
    if (mask == 0) continue;
    const auto move = [&](const auto* from, auto* at) WOBBLEBENCH_AVX512 {
      _mm512_storeu_si512(at + kept,
                          _mm512_maskz_compress_epi32(mask, _mm512_loadu_si512(from + i)));
    };
    move(cells.axial, to.axial);
    move(cells.lateral, to.lateral);
    move(cells.elevation, to.elevation);
    move(cells.key, to.key);
    move(cells.row, to.row);
    kept += std::popcount(static_cast<std::uint32_t>(mask));
  }
  return kept;
}

WOBBLEBENCH_AVX512 int list_at_once(const std::uint8_t* flags, int count, std::int32_t* list) {
  static_assert(kFlagsTogether == 16);
  __m512i numbers = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  int listed = 0;
  for (int i = 0; i < count; i += kFlagsTogether) {
    const __m128i here = _mm_loadu_si128(reinterpret_cast<const __m128i*>(flags + i));
    const __mmask16 mask = _mm_test_epi8_mask(here, here);
    _mm512_storeu_si512(list + listed, _mm512_maskz_compress_epi32(mask, numbers));
    listed += std::popcount(static_cast<std::uint32_t>(mask));
    numbers = _mm512_add_epi32(numbers, _mm512_set1_epi32(kFlagsTogether));
  }
  return listed;
}

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
         __builtin_cpu_supports("avx512bw") != 0;
}

const PackLanes pack = has_avx512() ? pack_at_once : pack_one_by_one;
const PackCells pack_touched = has_avx512() ? pack_cells_at_once : pack_cells_one_by_one;
const ListFlags list_set = has_avx512() ? list_at_once : list_one_by_one;
#else
constexpr PackLanes pack = pack_one_by_one;
constexpr PackCells pack_touched = pack_cells_one_by_one;
constexpr ListFlags list_set = list_one_by_one;
#endif

}  // namespace

int pack_lanes(const CellLanes& lanes, int cells, const SeenScatterers& to, std::uint8_t* which) {
  return pack(lanes, cells, to, which);
}

int pack_cells(const TestedCells& cells,
               const std::uint8_t* flags,
               int count,
               const TouchedHashCells& to) {
  return pack_touched(cells, flags, count, to);
}

int list_flags(const std::uint8_t* flags, int count, std::int32_t* list) {
  return list_set(flags, count, list);
}

}  // namespace wobblebench::sim
