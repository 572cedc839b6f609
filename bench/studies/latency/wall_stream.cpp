#include "bench/studies/latency/wall_stream.h"

#include <stdexcept>

#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/stream/gl_stream_renderer.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

std::string board_text(const WallSetting& setting) {
  const std::string board = "sim,pace=realtime";
  return setting.faults.empty() ? board : board + ",faults=" + setting.faults;
}

}  // namespace

StreamResult run_wall_stream(const WallSetting& setting,
                             render::GlContext& context,
                             PhantomCache& cache) {
  BoardConnection connection(parse_board(board_text(setting)));
  const ResolvedScene scene = resolve_scene(setting.scene, cache.phantom(setting.scene.phantom));
  render::Renderer renderer(context, scene.plan(), scene.render());
  renderer.compile();
  const StreamSource source = connection.connect(scene, kept_maps(cache.tissue_maps()));
  GlStreamRenderer passes(renderer);
  StreamResult result = run_stream(
      source, passes, {.queue = setting.queue}, [](const ShownPicture&) {}, [] { return false; });
  if (!result.failure.empty()) throw std::runtime_error(result.failure);
  std::erase_if(result.records,
                [](const PictureTimes& times) { return times.volume < kWarmUpVolumes; });
  std::erase_if(result.spans, [](const StreamSpan& span) { return span.volume < kWarmUpVolumes; });
  return result;
}

}  // namespace wobblebench::bench
