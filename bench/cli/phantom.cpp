// Builds or imports a phantom, prints its properties, and writes it for other OpenVDB tools.
#include <memory>

#include "bench/cache/phantom_cache.h"
#include "bench/cli/phantom_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
};

/// The scene with the phantom's placement. A motion that the phantom cannot make is no fault: it is
/// written at rest.
Scene placed_scene(const Scene& given, const phantoms::Phantom& phantom) {
  Scene at_rest = given;
  at_rest.motion = {};
  Scene placed = resolve_scene(at_rest, phantom).options();
  placed.motion = given.motion;
  return placed;
}

int write_phantom(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  return run_in_folder(
      arguments.output, {{"phantom", 10}, {"write", 1}}, [&](OutputFolder& out, Progress& progress) {
        PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
        const auto phantom = progress.step("phantom", [&] { return cache.phantom(scene.phantom); });
        progress.step("write", [&] { phantoms::write_phantom(phantom, out.stage("phantom.vdb")); });
        return CommandResult{phantom_report(phantom, placed_scene(scene, phantom)),
                             phantom_summary(phantom, out.directory() / "phantom.vdb")};
      });
}

}  // namespace

Command add_phantom_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(app, "phantom", "Build a phantom and write it as phantom.vdb");
  add_scene_options(command, arguments->scene);
  add_cache_options(command, arguments->cache);
  add_output_options(command, arguments->output);
  return {&command, [arguments] { return write_phantom(*arguments); }};
}

}  // namespace wobblebench::bench
