#include "sim/math/stream_compaction.h"

#include <bit>
#include <cstddef>
#include <cstring>

#include "sim/math/simd.h"

#if WOBBLEBENCH_HAND_SIMD
#include <immintrin.h>
#endif

namespace wobblebench::sim {

namespace {

using PackLanes = int (*)(const ScattererLanes&, int, const SeenScatterers&, std::uint8_t*);
using ListFlags = int (*)(const std::uint8_t*, int, std::int32_t*);

int pack_one_by_one(const ScattererLanes& lanes,
                    int count,
                    const SeenScatterers& to,
                    std::uint8_t* which) {
  int kept = 0;
  for (int first = 0; first < count; first += 8) {
    std::uint32_t mask = 0;
    for (int i = 0; i < 8; ++i) {
      to.path_m[kept] = lanes.path_m[first + i];
      to.places[kept] = lanes.places[first + i];
      to.amplitude[kept] = lanes.amplitude[first + i];
      kept += lanes.within[first + i];
      mask |= static_cast<std::uint32_t>(lanes.within[first + i]) << i;
    }
    which[first / 8] = static_cast<std::uint8_t>(mask);
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

WOBBLEBENCH_AVX512 int pack_at_once(const ScattererLanes& lanes,
                                    int count,
                                    const SeenScatterers& to,
                                    std::uint8_t* which) {
  static_assert(kFlagsTogether == 16);
  int kept = 0;
  for (int i = 0; i < count; i += kFlagsTogether) {
    const __m512i within = _mm512_loadu_si512(lanes.within + i);
    const __mmask16 mask = _mm512_test_epi32_mask(within, within);
    const auto move = [&](const auto* from, auto* at) WOBBLEBENCH_AVX512 {
      _mm512_storeu_si512(at + kept,
                          _mm512_maskz_compress_epi32(mask, _mm512_loadu_si512(from + i)));
    };
    move(lanes.path_m, to.path_m);
    move(lanes.places, to.places);
    move(lanes.amplitude, to.amplitude);
    std::memcpy(which + i / 8, &mask, sizeof mask);
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
const ListFlags list_set = has_avx512() ? list_at_once : list_one_by_one;
#else
constexpr PackLanes pack = pack_one_by_one;
constexpr ListFlags list_set = list_one_by_one;
#endif

}  // namespace

int pack_lanes(const ScattererLanes& lanes,
               int count,
               const SeenScatterers& to,
               std::uint8_t* which) {
  return pack(lanes, count, to, which);
}

int list_flags(const std::uint8_t* flags, int count, std::int32_t* list) {
  return list_set(flags, count, list);
}

}  // namespace wobblebench::sim
