// Loops that are worth a wide machine. WOBBLEBENCH_SIMD compiles a function once for each of three
// widths and picks at load time. Products are never fused with sums (-ffp-contract=off) and each
// element is computed by itself, so that all widths give the same bytes.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define WOBBLEBENCH_SIMD __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
/// Where a loop needs an instruction that no loop in C++ becomes: versions of a function by hand.
#define WOBBLEBENCH_HAND_SIMD 1
#else
// Sanitizers intercept calls before the choice among clones is made.
#define WOBBLEBENCH_SIMD
#define WOBBLEBENCH_HAND_SIMD 0
#endif

/// For what such loops call: it must become part of each clone.
#define WOBBLEBENCH_INLINE [[gnu::always_inline]] inline
