// Tables I to IV of the paper (docs/references.md [1]): rendering time against frames, volume size,
// 3D kernel and 2D kernel; and the pipeline variants in which their rows are rendered.
#pragma once

#include <string>
#include <vector>

#include "render/options.h"

namespace wobblebench::bench {

/// One line of a table: what it changes against the reference settings.
struct TableRow {
  std::string setting;  ///< its name in the paper
  double paper_ms = 0;
  int frames = 37;
  int side = 512;  ///< pixels, steps and slice side
  int kernel_3d = 3;
  int kernel_2d = 9;
};

struct PaperTable {
  std::string id;  ///< "I" to "IV"
  std::string title;
  std::vector<TableRow> rows;
};

/// The paper's rows. Its Table IV varies the kernel around 9 x 9, which it does not list.
const std::vector<PaperTable>& paper_tables();
/// The row that all ratios refer to: 37 frames, 512^3, 3^3, 9 x 9.
const TableRow& reference_row();
/// The different numbers of frames per volume of all rows, rising.
std::vector<int> frame_counts();

/// `base` with the row's settings; sides are the paper's over `divisor`.
render::RenderOptions settings_of(const TableRow& row, render::RenderOptions base, int divisor);

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
std::vector<PipelineVariant> variants_of(const PaperTable& table);

render::RenderOptions rendered(PipelineVariant variant, render::RenderOptions options);

/// How a run of the tables differs from the paper's, and how often each setting is measured.
struct TableRun {
  int divisor = 1;        ///< sides are the paper's over this
  int repeats = 3;        ///< measurements of the fast variants, after one warm-up
  int plain_repeats = 3;  ///< of the plain variants, likewise

  int repeats_of(PipelineVariant variant) const {
    return variant == PipelineVariant::plain || variant == PipelineVariant::plain_slice
               ? plain_repeats
               : repeats;
  }
};

}  // namespace wobblebench::bench
