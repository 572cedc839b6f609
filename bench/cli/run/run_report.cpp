#include "bench/cli/run/run_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "bench/cli/board_report.h"
#include "bench/output/camera_matrices.h"
#include "bench/output/error_report.h"
#include "bench/output/picture/label_picture.h"
#include "bench/output/report.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/studies/fit/fit_report.h"

namespace wobblebench::bench {

namespace {

Provenance provenance_of(const RunResult& result) {
  Provenance provenance = provenance_of_this_machine();
  provenance.gl_backend = result.gl_backend;
  provenance.gl_renderer = result.gl_renderer;
  provenance.board = hw::to_string(result.acquisition.link.origin);
  return provenance;
}

std::string why_not_registered(const RunResult& result) {
  return result.comparison ? "not asked for; --register fits it" : "no true surface is known";
}

std::string volume_line(const RunResult& result, const ResolvedScene& scene) {
  const Acquisition& acquisition = result.acquisition;
  const double sound_ms = to_milliseconds(scene.plan().volume_duration());
  const std::string sound = !acquisition.knows_times
                                ? "volume      of unknown times, "
                                : "volume      " + rounded(sound_ms) + " ms of sound, " +
                                      rounded(1 / scene.plan().stick_period_s()) + " lines/s, ";
  if (!acquisition.simulated) {
    return sound + std::string(hw::to_string(acquisition.link.origin)) + ", samples " +
           std::string(hw::to_string(acquisition.source)) + "\nscale       " +
           display_scale_text(acquisition.display_scale) + "\n";
  }
  const SimulatedVolume& simulated = *acquisition.simulated;
  return sound + "simulated in " + rounded(simulated.volume_ms) + " ms (before the first: waited " +
         fixed(simulated.map_ms, 0) + " ms for the tissue map" +
         (result.kept.tissue_map ? ", cached, " : ", ") + rounded(simulated.once_ms) +
         " ms for beam and speckle" + (result.kept.echoes ? ", cached" : "") + ")\nsimulator   " +
         sim::to_string(simulated.fidelity.rung) + ": " + simulated.fidelity.reason + "\n";
}

std::string board_line(const hw::BoardAccount& account) {
  return "board       " + std::to_string(account.emitted) + " sticks emitted, " +
         std::to_string(account.delivered) + " delivered" + losses_text(account) + "\n";
}

/// Only what is remarkable about the samples.
std::string samples_line(const ReceivedSamples& samples) {
  std::string line;
  if (samples.dynamic_range_db) {
    line += "samples     linear envelopes, log-compressed over " +
            rounded(*samples.dynamic_range_db) + " dB (simulation.dynamic_range_db)\n";
  }
  if (samples.out_of_range == 0) return line;
  return line + "samples     " + std::to_string(samples.out_of_range) + " of " +
         std::to_string(samples.count) + " out of range and clamped: they go from " +
         rounded(static_cast<double>(samples.least)) + " to " +
         rounded(static_cast<double>(samples.most)) + "\n";
}

/// Source of the truth; empty: there is none.
std::string truth_source(const RunResult& result) {
  if (!result.comparison) return "";
  if (result.acquisition.simulated) return "simulated scene";
  return result.acquisition.subject.stated() ? "recorded scene" : "scene, on trust";
}

std::string truth_line(const RunResult& result) {
  if (truth_source(result) != "scene, on trust") return "";
  return "truth       taken from the scene on trust: the samples do not say what they are of\n";
}

/// Why there is nothing to compare with; empty: there is.
std::string no_truth(const RunResult& result) {
  if (result.comparison) return "";
  return "samples from " + std::string(hw::to_string(result.acquisition.source)) +
         ": what they are of is not known";
}

/// Null where no detector needs them.
Json levels_json(const std::optional<render::SurfaceLevels>& levels) {
  if (!levels) return nullptr;
  Json json = {
      {"fluid", levels->fluid}, {"tissue", levels->tissue}, {"separate", levels->separate}};
  if (levels->of_sticks) json["of_sticks"] = {levels->of_sticks->first, levels->of_sticks->second};
  return json;
}

/// What --register fitted, with 95 % intervals; empty: it was not asked for.
std::string registration_lines(const RunResult& result) {
  if (!result.comparison || !result.comparison->registration) return "";
  const Registration& fit = *result.comparison->registration;
  if (!std::isfinite(fit.rms_after_m)) {
    return "registered  nothing: " + std::to_string(fit.points) + " of " +
           std::to_string(fit.sampled) + " found points lie near the true surface, too few\n";
  }
  std::string lines = "registered  " + std::to_string(fit.points) + " points, RMS distance " +
                      in_mm(fit.rms_before_m) + " mm before, " + in_mm(fit.rms_after_m) +
                      " mm after" + (fit.converged ? "" : "; did NOT converge") +
                      (fit.within_priors ? "" : "; beyond the priors, no calibration error") + "\n";
  for (int i = 0; i < kRegistrationParameters; ++i) {
    if (fit.standard_deviation(i) > 0) lines += "            " + fitted_text(fit, i) + "\n";
  }
  for (const UnseenParameters& unseen : fit.unseen) {
    lines += "            not told apart by the data:";
    for (const int parameter : unseen.parameters) {
      lines += " " + registration_names().at(static_cast<std::size_t>(parameter));
    }
    lines += "\n";
  }
  return lines;
}

/// Texture fetches of each pass; null: not counted.
Json fetches_json(const std::vector<render::PassTime>& counted) {
  if (counted.empty()) return nullptr;
  Json passes = Json::array();
  for (const render::PassTime& pass : counted) {
    std::int64_t fetches = 0;
    for (const auto& [kind, count] : pass.fetches) fetches += count;
    passes.push_back({{"name", pass.name}, {"fetches", fetches}});
  }
  return passes;
}

}  // namespace

ToleranceResult tolerance_result(const ToleranceChoice& choice, const RunResult& result) {
  // A simulated scene has a truth.
  return {choice,
          tolerance_outcome(choice, result.comparison.value().error),
          frame_ms(result.picture.passes)};
}

std::string run_report(const RunResult& result,
                       const ResolvedScene& scene,
                       const StepTimes& times,
                       const std::optional<ToleranceResult>& tolerance) {
  Json report = report_head("run", provenance_of(result), scene.options());
  const auto& simulated = result.acquisition.simulated;
  report["acquisition"] = acquisition_json(scene.plan(), result.acquisition.knows_times);
  report["acquisition"]["motor_angles"] = motor_json(result.motor);
  report_simulation(report, simulated, scene.plan());
  if (!simulated) report_stream_scale(report, result.acquisition.display_scale);
  report["board"] = board_json(result.acquisition);
  report["timing"]["board"] = board_timing_json(result.acquisition);
  report["render"] = render_json(result.picture.passes, scene.render().pipeline.mode);
  report["camera"] = camera_json(scene.view().camera);
  report["render"]["texture_fetches"] = fetches_json(result.counted);
  report["render"]["levels"] = levels_json(result.picture.levels);
  const std::string truth = truth_source(result);
  report["truth"] = truth.empty() ? Json(nullptr) : Json(truth);
  report["measures"] = scene.subject() ? measures_json(scene.subject()->phantom) : Json(nullptr);
  report["labels"] = nullptr;
  report["error"] = nullptr;
  report["fit"] = {{"registration", nullptr}, {"why_not", why_not_registered(result)}};
  if (const auto& comparison = result.comparison) {
    report["error"] = error_json(comparison->error, expected_surface(scene));
    if (comparison->labels) {
      report["labels"] = labels_json(comparison->truth, *comparison->labels);
    }
    if (comparison->registration) {
      report["fit"] = {{"registration", registration_json(*comparison->registration)}};
    }
  }
  report["no_truth_because"] = result.comparison ? Json(nullptr) : Json(no_truth(result));
  if (!result.comparison) {
    for (const char* unused : {"phantom", "placement", "motion", "simulation"}) {
      report["scene"][unused] = nullptr;
    }
  }
  if (tolerance) report["tolerance"] = tolerance_json(*tolerance);
  report["cached"] = {{"phantom", result.kept.phantom},
                      {"tissue_map", result.kept.tissue_map},
                      {"echoes", result.kept.echoes}};
  report["wall_ms"] = wall_json(times);
  return report_text(report);
}

std::string run_summary(const RunResult& result,
                        const ResolvedScene& scene,
                        const std::filesystem::path& directory,
                        const std::optional<ToleranceResult>& tolerance) {
  return volume_line(result, scene) + board_line(result.acquisition.account) + "render      " +
         rounded(frame_ms(result.picture.passes)) + " ms on " + result.gl_renderer + "\n" +
         samples_line(result.acquisition.samples) +
         (result.framed.empty() ? "" : "frame       " + result.framed + "\n") + truth_line(result) +
         (result.comparison ? error_text(*result.comparison, scene)
                            : "truth       none; " + no_truth(result) + "\n") +
         registration_lines(result) + (tolerance ? tolerance_lines(*tolerance) : "") +
         "results     " + directory.string() + "\n";
}

std::string ending_text(const RunResult& result) {
  return result.acquisition.ending + ": " +
         std::to_string(result.acquisition.volume.missing_sticks()) +
         " sticks of the volume are missing";
}

}  // namespace wobblebench::bench
