// Whether mode fast makes mode plain's picture.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "bench/cli/commands.h"
#include "bench/cli/progress.h"
#include "bench/cli/user_error.h"
#include "bench/pipeline/acquire.h"
#include "bench/report/output_folder.h"
#include "bench/report/report.h"
#include "bench/studies/mode_agreement.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

using Rows = std::vector<ModeAgreement>;

bool all_same(const Rows& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.depth.same(); });
}

/// The scene's own phantom where it names one, else four: bent, round, flat, and nothing but
/// speckle.
std::vector<std::string> phantoms_of(const Scene& scene) {
  if (scene.given.contains("phantom.name")) return {scene.phantom.name};
  return {"fetal_face", "sphere", "plane", "speckle_block"};
}

Rows measure(Scene scene, const std::string& name, render::GlContext& context, Progress& progress) {
  scene.phantom.name = name;
  return progress.step(name, [&] {
    const auto phantom = phantoms::make_phantom(scene.phantom);
    complete_from_phantom(scene, phantom);
    const Acquisition acquisition = acquire_simulated(scene, phantom);
    return measure_mode_agreement(name, acquisition.volume, scene.render, context);
  });
}

std::string heading(const Scene& scene, const Provenance& provenance) {
  const auto& o = scene.render.ray_casting;
  std::ostringstream text;
  text << "# Mode fast against mode plain\n\nWritten by `wobblebench modes`. CPU: "
       << provenance.cpu << ", " << provenance.threads << " threads. GL: " << provenance.gl_backend
       << ", " << provenance.gl_renderer << ". Commit: " << provenance.commit
       << ". Seed: " << provenance.seed << ". Sticks: simulated.\n\nOne volume of each phantom, "
       << o.image_size << "² rays of " << o.steps << " steps; the " << o.kernel_3d
       << "³ kernel lies "
       << (o.kernel_space == render::KernelSpace::slice ? "in the slices" : "along the ray")
       << " in both modes. z: ray length at the surface, in steps. Changed: pixels where one mode "
          "alone found a surface, and those where both did, but more than "
       << kSameSurfaceSteps
       << " step apart: there Difference meets the threshold within rounding, and the ray goes on "
          "to "
          "another edge. Asked: z within "
       << kMostRmsSteps << " steps RMS, and " << kMostChangedPercent
       << " % of the pixels changed at most. The last columns leave nothing out.\n\n";
  return text.str();
}

std::string page_of(const Rows& rows, const Scene& scene, const Provenance& provenance) {
  std::ostringstream page;
  page << heading(scene, provenance)
       << "| phantom | from | yaw, pitch (deg) | found by both | by one | elsewhere | changed % | "
          "RMS steps | | RMS of all | greatest |\n"
          "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: | ---: |\n"
       << std::setprecision(2);
  for (const ModeAgreement& row : rows) {
    const DepthAgreement& d = row.depth;
    page << "| " << row.phantom << " | " << row.direction.name << " | "
         << std::lround(row.direction.yaw_rad / kDegree) << ", "
         << std::lround(row.direction.pitch_rad / kDegree) << " | " << d.both_hit << " | "
         << d.one_hit << " | " << d.elsewhere << " | " << d.changed_percent() << " | "
         << d.rms_steps << " | " << (d.same() ? "same" : "DIFFERS") << " | " << d.rms_all_steps
         << " | " << d.worst_steps << " |\n";
  }
  return page.str();
}

Json rows_json(const Rows& rows) {
  Json list = Json::array();
  for (const ModeAgreement& row : rows) {
    const DepthAgreement& d = row.depth;
    list.push_back({{"phantom", row.phantom},
                    {"yaw_deg", row.direction.yaw_rad / kDegree},
                    {"pitch_deg", row.direction.pitch_rad / kDegree},
                    {"pixels", d.pixels},
                    {"both_hit", d.both_hit},
                    {"one_hit", d.one_hit},
                    {"elsewhere", d.elsewhere},
                    {"changed_percent", d.changed_percent()},
                    {"rms_steps", d.rms_steps},
                    {"rms_all_steps", d.rms_all_steps},
                    {"worst_steps", d.worst_steps},
                    {"same", d.same()}});
  }
  return list;
}

void refuse_what_modes_set(const Scene& scene) {
  for (const char* key : {"render.pipeline.mode", "render.view.yaw_deg", "render.view.pitch_deg"}) {
    if (scene.given.contains(key)) {
      throw UserError(std::string(key) + ": is set by the comparison itself; leave it out");
    }
  }
  if (scene.render.ray_casting.mode == render::RenderMode::volume) {
    throw UserError("render.ray_casting.mode = \"volume\": must be surface or both; z is compared");
  }
}

}  // namespace

int modes_command(const CommandArguments& arguments) {
  const Scene scene = load_scene(arguments.scene, arguments.settings);
  refuse_what_modes_set(scene);
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.out);
  Progress progress;
  Rows rows;
  for (const std::string& name : phantoms_of(scene)) {
    const Rows more = measure(scene, name, *context, progress);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  Provenance provenance = provenance_of_this_machine();
  provenance.gl_backend = context->backend();
  provenance.gl_renderer = context->renderer_string();
  provenance.board = "simulated";
  provenance.seed = scene.simulation.seed;
  Json report = report_head("modes", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["modes"] = rows_json(rows);
  const std::string page = page_of(rows, scene, provenance);
  out.write_text("modes.md", page);
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  std::cout << (arguments.json ? report.dump(2) + "\n" : page);
  return all_same(rows) ? 0 : 1;
}

}  // namespace wobblebench::bench
