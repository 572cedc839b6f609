#include "bench/studies/modes/modes_report.h"

#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/output/report.h"

namespace wobblebench::bench {

namespace {

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

Json rows_json(const std::vector<ModeAgreement>& rows) {
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

}  // namespace

std::string modes_report(const std::vector<ModeAgreement>& rows,
                         const Scene& scene,
                         const Provenance& provenance) {
  Json report = report_head("modes", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["modes"] = rows_json(rows);
  return report_text(report);
}

std::string modes_markdown(const std::vector<ModeAgreement>& rows,
                           const Scene& scene,
                           const Provenance& provenance) {
  std::ostringstream text;
  text << heading(scene, provenance)
       << "| phantom | from | yaw, pitch (deg) | found by both | by one | elsewhere | changed % | "
          "RMS steps | | RMS of all | greatest |\n"
          "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: | ---: |\n"
       << std::setprecision(2);
  for (const ModeAgreement& row : rows) {
    const DepthAgreement& d = row.depth;
    text << "| " << row.phantom << " | " << row.direction.name << " | "
         << std::lround(row.direction.yaw_rad / kDegree) << ", "
         << std::lround(row.direction.pitch_rad / kDegree) << " | " << d.both_hit << " | "
         << d.one_hit << " | " << d.elsewhere << " | " << d.changed_percent() << " | "
         << d.rms_steps << " | " << (d.same() ? "same" : "DIFFERS") << " | " << d.rms_all_steps
         << " | " << d.worst_steps << " |\n";
  }
  return text.str();
}

}  // namespace wobblebench::bench
