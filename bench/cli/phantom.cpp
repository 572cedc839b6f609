// Builds or imports a phantom, prints its properties, and writes it for other OpenVDB tools.
#include <iostream>
#include <memory>

#include "bench/cache/phantom_cache.h"
#include "bench/cli/phantom_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
};

int write_phantom(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  OutputFolder out(arguments.output.folder);
  Progress progress({{"phantom", 10}, {"write", 1}});
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  const auto phantom = progress.step("phantom", [&] { return cache.phantom(scene.phantom); });
  complete_from_phantom(scene, phantom);
  progress.step("write", [&] { phantoms::write_phantom(phantom, out.stage("phantom.vdb")); });

  const std::string report = phantom_report(phantom, scene);
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report
                                      : phantom_summary(phantom, out.directory() / "phantom.vdb"));
  return 0;
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
