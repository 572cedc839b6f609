// Build a phantom and write it for other OpenVDB tools.
#include <iostream>

#include "bench/commands/commands.h"
#include "bench/output_folder.h"
#include "bench/progress.h"
#include "bench/report.h"

namespace wobblebench::bench {

namespace {

Json phantom_json(const phantoms::Phantom& phantom) {
  Json surfaces = Json::array();
  for (const auto& surface : phantom.surfaces()) {
    surfaces.push_back(
        {{"name", surface.name},
         {"inside", phantom.materials().at(static_cast<std::size_t>(surface.inside)).name},
         {"target", surface.is_target}});
  }
  return {
      {"name", phantom.name()},
      {"background", phantom.materials().at(static_cast<std::size_t>(phantom.background())).name},
      {"surfaces", surfaces}};
}

}  // namespace

int phantom_command(const CommandArguments& arguments) {
  Scene scene = load_scene(arguments.scene, arguments.settings);
  OutputFolder out(arguments.out);
  Progress progress;
  const auto phantom =
      progress.step("phantom", [&] { return phantoms::make_phantom(scene.phantom); });
  complete_from_phantom(scene, phantom);
  progress.step("write", [&] { phantoms::write_phantom(phantom, out.stage("phantom.vdb")); });
  Json report = report_head("phantom", provenance_of_this_machine(), scene);
  report["phantom"] = phantom_json(phantom);
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  if (arguments.json) {
    std::cout << report.dump(2) << "\n";
  } else {
    std::cout << report["phantom"].dump(2) << "\n"
              << (out.directory() / "phantom.vdb").string() << "\n";
  }
  return 0;
}

}  // namespace wobblebench::bench
