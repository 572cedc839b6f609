// How long a context takes over each stage of a stream: what `latency` predicts another machine by.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/tables/paper.h"
#include "bench/studies/tables/volumes.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// Wall times in the order in which they were measured, until GL is done.
struct StageTimes {
  std::string settings;               ///< "paper": of the reference row; "default"
  int frames = 0;                     ///< a volume
  std::vector<double> frame_ms;       ///< upload and pass 1 of a frame that does not end a volume
  std::vector<double> last_frame_ms;  ///< of the one that does
  std::vector<double> picture_ms;     ///< passes 2 to 4, and reading the picture
  std::vector<double> new_view_ms;    ///< the same of the same volume from 10 degrees aside
};

/// The paper's settings and the default ones (render::RenderPreset::accurate), slices and pictures
/// of the run's sides.
render::RenderOptions paper_settings(const TableRun& run);
render::RenderOptions default_settings(const TableRun& run);

/// Both settings, with the most frames and the fewest that the tables have, all in turn in each of
/// run.repeats, after one that does not count. Throws as render::Renderer does.
std::vector<StageTimes> measure_stages(const TableVolumes& volumes,
                                       render::GlContext& context,
                                       const TableRun& run);

}  // namespace wobblebench::bench
