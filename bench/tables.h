// Tables I to IV of the paper (docs/references.md [1]): rendering time against frames, volume size,
// 3D kernel and 2D kernel, with the paper's column beside ours.
#pragma once

#include <string>
#include <vector>

#include "bench/scene.h"
#include "bench/spread.h"
#include "render/gl_context.h"

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
std::vector<Table> paper_tables();
/// The row that every other is held against: 37 frames, 512^3, 3^3, 9 x 9.
TableRow reference_row();

struct TableRun {
  int divisor = 1;  ///< sides are the paper's over this
  int repeats = 3;  ///< counted, after one that is not
};

struct MeasuredRow {
  TableRow row;
  Spread frame_ms;              ///< all four passes, all frames
  std::vector<double> pass_ms;  ///< medians, in the renderer's order
  double ratio = 0;             ///< of the median to the reference row's
  double paper_ratio = 0;
};

struct MeasuredTable {
  std::string id;
  std::string title;
  std::vector<MeasuredRow> rows;
};

struct TableResults {
  std::string board;                 ///< provenance of the sticks
  std::vector<std::string> effects;  ///< that made them
  std::vector<MeasuredTable> tables;
  std::vector<std::string> pass_names;
  MeasuredRow reference;
};

/// Puts the reference settings into the scene. Throws UserError where the scene gives a setting
/// that the tables vary or hold themselves.
void take_reference_settings(Scene& scene, const TableRun& run);

/// Scans the phantom once for each number of frames, then renders every row in turn, all rows in
/// each repeat, so that a drift of the machine's speed touches all alike.
TableResults measure_tables(const Scene& scene,
                            const phantoms::Phantom& phantom,
                            render::GlContext& context,
                            const TableRun& run);

/// Says in one sentence how the run differs from the paper's.
std::string describe_run(const TableRun& run);

std::string to_markdown(const TableResults& results, const TableRun& run);
std::string to_csv(const TableResults& results, const TableRun& run);

}  // namespace wobblebench::bench
