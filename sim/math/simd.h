// Attributes for vectorised loops. WOBBLEBENCH_SIMD compiles a function three times (SSE2, AVX2,
// AVX-512) and selects one when the program is loaded. Products are never fused with sums
// (-ffp-contract=off) and each element is computed independently, so all three give the same bytes.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WOBBLEBENCH_SIMD __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
/// 1: functions may have a version with intrinsics, for instructions that compilers do not generate
/// from a C++ loop.
#define WOBBLEBENCH_INTRINSICS 1
#else
// Sanitizers intercept calls before the clone is selected.
#define WOBBLEBENCH_SIMD
#define WOBBLEBENCH_INTRINSICS 0
#endif

/// For functions called in vectorised loops: they must be inlined into each clone.
#define WOBBLEBENCH_INLINE [[gnu::always_inline]] inline
