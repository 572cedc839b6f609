#include "bench/studies/tables/tables_command.h"

#include <utility>

#include "base/user_error.h"
#include "bench/pipeline/acquire.h"

namespace wobblebench::bench {

void take_reference_settings(Scene& scene, const TableRun& run) {
  for (const char* key : {"acquisition.frames_per_volume",
                          "render.pipeline.mode",
                          "render.scan_conversion.slice_size",
                          "render.ray_casting.image_size",
                          "render.ray_casting.steps",
                          "render.ray_casting.kernel_3d",
                          "render.ray_casting.kernel_space",
                          "render.ray_casting.mode",
                          "render.shading.base",
                          "render.shading.depth_filter_size",
                          "render.smoothing.filter_size"}) {
    if (scene.given.contains(key)) {
      throw UserError(std::string(key) + ": is set by the tables themselves; leave it out");
    }
  }
  scene.acquisition.frames_per_volume = reference_row().frames;
  scene.render = settings_of(reference_row(), scene.render, run.divisor);
}

TableVolumes scan_table_volumes(const Scene& scene,
                                const phantoms::Phantom& phantom,
                                const BoardArguments& board,
                                const sim::TissueMapSource& maps,
                                const PartDone& done) {
  TableVolumes volumes;
  PartCount parts(frame_counts().size(), done);
  for (const int frames : frame_counts()) {
    Scene varied = scene;
    varied.acquisition.frames_per_volume = frames;
    Acquisition acquisition = BoardConnection(board).acquire(varied, varied.place(phantom), maps);
    volumes.board = hw::to_string(acquisition.link.origin);
    volumes.effects = acquisition.simulated.value().effects;
    volumes.by_frames.emplace(frames, std::move(acquisition.volume));
    parts.finish_one();
  }
  return volumes;
}

}  // namespace wobblebench::bench
