// Tables I to IV of the paper (docs/references.md [1]): rendering time against frames, volume size,
// 3D kernel and 2D kernel.
#pragma once

#include <string>
#include <vector>

#include "render/options.h"

namespace wobblebench::bench {

/// One line of a table: what it changes against the reference settings.
struct TableRow {
  std::string setting;  ///< as the paper names it
  double paper_ms = 0;
  int frames = 37;
  int side = 512;  ///< pixels, steps and slice side
  int kernel_3d = 3;
  int kernel_2d = 9;
};

struct Table {
  std::string id;  ///< "I" to "IV"
  std::string title;
  std::vector<TableRow> rows;
};

/// The paper's rows. Its Table IV varies the kernel around 9 x 9, which it does not list.
const std::vector<Table>& paper_tables();
/// The row that all ratios refer to: 37 frames, 512^3, 3^3, 9 x 9.
const TableRow& reference_row();
/// The different numbers of frames per volume of all rows, rising.
std::vector<int> frame_counts();

/// `base` with the row's settings; sides are the paper's over `divisor`.
render::RenderOptions settings_of(const TableRow& row, render::RenderOptions base, int divisor);

}  // namespace wobblebench::bench
