// Renders the first volume of a board as a scene says, and writes its depth: what `wobblebench run`
// does, to the byte. Links the bench: find_package(wobblebench COMPONENTS bench).
//
//   render_scene docs/scenes/sphere.toml sim depth.exr
//   render_scene docs/scenes/sphere.toml file=out/recording.wbst depth.exr
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>

#include "wobblebench/base/user_error.h"
#include "wobblebench/bench/cache/phantom_cache.h"
#include "wobblebench/bench/output/image_io.h"
#include "wobblebench/bench/output/progress.h"
#include "wobblebench/bench/pipeline/acquire.h"
#include "wobblebench/bench/pipeline/stream/gl_stream_renderer.h"
#include "wobblebench/bench/scene/resolved_scene.h"
#include "wobblebench/bench/scene/scene.h"
#include "wobblebench/render/gl/context.h"
#include "wobblebench/render/renderer.h"

namespace {

using namespace wobblebench;

void write_depth(const render::Picture& picture, const render::Camera& camera, const char* path) {
  const auto bytes = bench::depth_exr(picture, camera);
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw std::runtime_error(std::string(path) + ": cannot be written");
}

void render_scene(const char* scene_file, const char* board_text, const char* depth_file) {
  const bench::Scene given = bench::load_scene(scene_file, {});
  bench::BoardConnection board(bench::parse_board(board_text));
  bench::PhantomCache cache;
  bench::Progress progress;
  const bench::ResolvedScene scene = board.resolve(given, cache, progress);
  const auto context = render::make_context();
  render::Renderer renderer(*context, scene.plan(), scene.render());
  bench::GlStreamRenderer passes(renderer);
  render::Picture picture;
  const auto keep = [&](const bench::ShownPicture& shown) { picture = shown.picture; };
  const auto acquired = board.acquire(board.connect(scene, cache.tissue_maps()), passes, keep);
  std::printf("%d sticks lost\n", acquired.volume.missing_sticks());
  write_depth(picture, scene.view().camera, depth_file);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "render_scene SCENE.toml BOARD DEPTH.exr\n");
    return 2;
  }
  try {
    render_scene(argv[1], argv[2], argv[3]);
    return 0;
  } catch (const UserError& error) {
    std::fprintf(stderr, "render_scene: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "render_scene: %s\n", error.what());
    return 1;
  }
}
