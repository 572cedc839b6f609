// Tables I to IV, measured.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "base/statistics.h"
#include "bench/studies/tables/paper.h"
#include "bench/studies/tables/stage_times.h"
#include "bench/studies/tables/volumes.h"
#include "hw/probe/polar_volume.h"
#include "render/gl/context.h"
#include "render/gl/texels.h"

namespace wobblebench::bench {

struct PassTiming {
  std::string name;
  double ms = 0;  ///< median
};

/// A row rendered in one variant.
struct Timing {
  Spread frame_ms;                 ///< all four passes, all frames, upload included
  std::vector<PassTiming> passes;  ///< in the renderer's order
  Quartiles ratio;  ///< to the reference row's in the same repeat, in the same variant
  MedianInterval median_ms = {};  ///< of frame_ms
};

struct MeasuredRow {
  TableRow row;
  double paper_ratio = 0;                     ///< to the paper's reference row
  std::map<PipelineVariant, Timing> timings;  ///< in variants_of() the table

  double ms(PipelineVariant variant) const { return timings.at(variant).frame_ms.median; }
  /// Plain over fast, by medians: of the frame, and of a pass (none where only one has it).
  double speed_up() const { return ms(PipelineVariant::plain) / ms(PipelineVariant::fast); }
  std::optional<double> pass_speed_up(const std::string& pass) const;
};

/// Exponents of time over the side: least squares of their logarithms.
struct Exponents {
  double paper = 0;
  double plain = 0;
  double fast = 0;
};

struct MeasuredTable {
  PaperTable table;
  std::vector<MeasuredRow> rows;
  std::optional<Exponents> exponents;  ///< where the side varies (Table II)
};

/// Times of an arriving frame and of a new picture at the reference settings.
struct Arrival {
  Spread add_frame_ms;   ///< Renderer::add_frame and update, until GL is done
  Spread new_volume_ms;  ///< upload and four passes of all frames
  Spread new_view_ms;    ///< passes 2 to 4 of the same volume
};

/// Lower bound of the time of a pass: its texture fetches at the rate that this machine reaches.
struct PassFloor {
  std::string pass;
  render::FetchCounts fetches;  ///< fetches of one whole frame, upload included
  double floor_ms = 0;          ///< time of these fetches alone

  std::int64_t total() const;
};

struct Floors {
  std::map<render::TextureFetch, double> rates_per_us;       ///< millions a second
  std::map<PipelineVariant, std::vector<PassFloor>> passes;  ///< in the renderer's order
};

/// "sampler2DArray rg16 linear".
std::string to_string(const render::TextureFetch& kind);

struct TableResults {
  std::vector<MeasuredTable> tables;
  MeasuredRow reference;
  std::map<PipelineVariant, Arrival> arrivals;  ///< plain and fast
  Floors floors;                                ///< floors of the reference row, plain and fast
  double frame_acquisition_ms = 0;              ///< reference row: volume time / frames
  std::vector<StageTimes> stages;

  const Arrival& arrival(PipelineVariant variant) const { return arrivals.at(variant); }
  /// How many times faster a frame is taken in than acquired, by the median.
  double times_acquisition(PipelineVariant variant) const {
    return frame_acquisition_ms / arrival(variant).add_frame_ms.median;
  }
};

/// Renders every row in turn, all rows and variants in each repeat, so that a drift of the
/// machine's speed affects all equally. `base`: settings that the rows do not set. Throws as
/// render::Renderer does.
TableResults measure_tables(const TableVolumes& volumes,
                            const render::RenderOptions& base,
                            render::GlContext& context,
                            const TableRun& run,
                            const PartDone& done = {});

/// Median of the pass; 0 where this variant has none of that name.
double pass_ms(const Timing& timing, const std::string& pass);

/// Exponent by least squares of log y on log x; at least two different x, all positive.
double power_of(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace wobblebench::bench
