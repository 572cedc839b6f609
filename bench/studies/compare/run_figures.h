// The figures of a run that two runs are compared by, read from its report.json.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/results/measure.h"

namespace wobblebench::bench {

/// How figures of a kind differ between two equal runs.
enum class FigureKind {
  error,  ///< of the picture against the truth: not at all on one machine
  time,   ///< with the load of the machine
  work,   ///< counted: not at all
};

/// "frame_ms" and all that end alike are times; fetches, sticks and samples are work.
FigureKind kind_of_figure(const std::string& name);
/// All names that a run of this program may have.
const std::vector<std::string>& run_figure_names();

/// Of a scene's first seed: the new side's shaded picture against the base's, as the files have it.
inline constexpr Measure kPictureSsim{"picture_ssim",
                                      "likeness of the pictures",
                                      "SSIM of both sides' shaded pictures",
                                      Worse::lower};

/// What a figure of a run is; null: of one pass.
const Measure* run_measure(const std::string& name);
/// The way in which a figure of a run gets worse.
Worse worse_of(const std::string& name);

/// Values by name: the measures of the whole picture as --limit names them, frame_ms and the time
/// of each pass, simulation_ms, run_ms; sticks, samples, and the texture fetches of the picture and
/// of each pass where they were counted. What the report does not have, or has as null, is left
/// out.
using RunFigures = std::map<std::string, double>;

/// `report`: of `wobblebench run`.
RunFigures figures_of_run(const nlohmann::ordered_json& report);

/// One run, and what it was made on.
struct MeasuredRun {
  std::string scene;
  std::uint64_t seed = 0;
  RunFigures figures;
};

struct MeasuredSide {
  std::string what;  ///< for people: program and settings, or where the figures were kept
  std::string commit, cpu, gl_renderer;
  bool kept = false;          ///< measured at another time
  std::string board = "sim";  ///< what --board is given, in every run
  std::vector<MeasuredRun> runs;
  /// The settings of each scene as resolved, by their keys ("render.shading.light"), without the
  /// seed: texts of JSON.
  std::map<std::string, std::map<std::string, std::string>> settings;
};

nlohmann::ordered_json json_of(const MeasuredSide& side);
/// "scene" of a report, as MeasuredSide::settings has it.
std::map<std::string, std::string> settings_in(const nlohmann::ordered_json& report);

/// From report.json of `compare` or `run`, whose scene has the phantom's name; `what`: of the side.
/// Throws UserError where it is neither.
MeasuredSide kept_side(const nlohmann::ordered_json& report, const std::string& what);

}  // namespace wobblebench::bench
