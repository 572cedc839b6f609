// The pipeline variants in which a row of the paper's tables is rendered.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/tables/paper.h"
#include "render/options.h"

namespace wobblebench::bench {

/// A pipeline, and the space in which the taps of its 3D kernel lie.
enum class PipelineVariant {
  plain,        ///< taps along the ray, as in the paper
  plain_slice,  ///< plain, taps in the slices
  fast,         ///< the default: taps in the slices
  fast_ray,     ///< fast, taps along the ray
};

/// "plain", "plain_slice", "fast", "fast_ray": what the keys of report.json begin with.
std::string to_string(PipelineVariant variant);

/// Plain and fast for every table; all four where the 3D kernel is what varies (Table III).
std::vector<PipelineVariant> variants_of(const Table& table);

render::RenderOptions rendered(PipelineVariant variant, render::RenderOptions options);

/// How a run of the tables differs from the paper's, and how often each setting is measured.
struct TableRun {
  int divisor = 1;        ///< sides are the paper's over this
  int repeats = 3;        ///< of the fast variants, after one warm-up
  int plain_repeats = 3;  ///< of the plain variants, likewise

  int repeats_of(PipelineVariant variant) const {
    return variant == PipelineVariant::plain || variant == PipelineVariant::plain_slice
               ? plain_repeats
               : repeats;
  }
};

}  // namespace wobblebench::bench
