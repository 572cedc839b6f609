#include "sim/speckle/scatterers/stream_compaction.h"

#include <bit>
#include <cstring>

#include "sim/math/fast_math.h"

#if WOBBLEBENCH_INTRINSICS
#include <immintrin.h>
#endif

namespace wobblebench::sim {

namespace {

using CompactFunction = int (*)(const ScattererLanes&,
                                int,
                                const ProjectedScatterers&,
                                std::uint8_t*);
using ListFunction = int (*)(const std::uint8_t*, int, std::int32_t*);

int compact_scalar(const ScattererLanes& lanes,
                   int count,
                   const ProjectedScatterers& to,
                   std::uint8_t* mask) {
  int kept = 0;
  for (int first = 0; first < count; first += 8) {
    std::uint32_t bits = 0;
    for (int i = 0; i < 8; ++i) {
      to.range_m[kept] = lanes.range_m[first + i];
      to.table_index[kept] = lanes.table_index[first + i];
      to.amplitude[kept] = lanes.amplitude[first + i];
      kept += lanes.selected[first + i];
      bits |= static_cast<std::uint32_t>(lanes.selected[first + i]) << i;
    }
    mask[first / 8] = static_cast<std::uint8_t>(bits);
  }
  return kept;
}

int list_scalar(const std::uint8_t* flags, int count, std::int32_t* list) {
  int listed = 0;
  for (int i = 0; i < count; ++i) {
    list[listed] = i;
    listed += flags[i];
  }
  return listed;
}

#if WOBBLEBENCH_INTRINSICS
#define WOBBLEBENCH_AVX512 __attribute__((target("avx512f,avx512vl,avx512bw,popcnt")))

WOBBLEBENCH_AVX512 int compact_avx512(const ScattererLanes& lanes,
                                      int count,
                                      const ProjectedScatterers& to,
                                      std::uint8_t* mask) {
  static_assert(kCompactionWidth == 16);
  int kept = 0;
  for (int i = 0; i < count; i += kCompactionWidth) {
    const __m512i selected = _mm512_loadu_si512(lanes.selected + i);
    const __mmask16 bits = _mm512_test_epi32_mask(selected, selected);
    const auto compress = [&](const auto* from, auto* at) WOBBLEBENCH_AVX512 {
      _mm512_storeu_si512(at + kept,
                          _mm512_maskz_compress_epi32(bits, _mm512_loadu_si512(from + i)));
    };
    compress(lanes.range_m, to.range_m);
    compress(lanes.table_index, to.table_index);
    compress(lanes.amplitude, to.amplitude);
    std::memcpy(mask + i / 8, &bits, sizeof bits);
    kept += std::popcount(static_cast<std::uint32_t>(bits));
  }
  return kept;
}

WOBBLEBENCH_AVX512 int list_avx512(const std::uint8_t* flags, int count, std::int32_t* list) {
  static_assert(kCompactionWidth == 16);
  __m512i indices = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  int listed = 0;
  for (int i = 0; i < count; i += kCompactionWidth) {
    const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(flags + i));
    const __mmask16 mask = _mm_test_epi8_mask(bytes, bytes);
    _mm512_storeu_si512(list + listed, _mm512_maskz_compress_epi32(mask, indices));
    listed += std::popcount(static_cast<std::uint32_t>(mask));
    indices = _mm512_add_epi32(indices, _mm512_set1_epi32(kCompactionWidth));
  }
  return listed;
}

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
         __builtin_cpu_supports("avx512bw") != 0;
}

const CompactFunction compact_function = has_avx512() ? compact_avx512 : compact_scalar;
const ListFunction list_function = has_avx512() ? list_avx512 : list_scalar;
#else
constexpr CompactFunction compact_function = compact_scalar;
constexpr ListFunction list_function = list_scalar;
#endif

}  // namespace

int compact_scatterers(const ScattererLanes& lanes,
                       int count,
                       const ProjectedScatterers& to,
                       std::uint8_t* mask) {
  return compact_function(lanes, count, to, mask);
}

int list_set_flags(const std::uint8_t* flags, int count, std::int32_t* list) {
  return list_function(flags, count, list);
}

}  // namespace wobblebench::sim
