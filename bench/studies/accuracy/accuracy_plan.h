// The plan of the command `accuracy`: scenes, rungs, render settings and seeds, by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/scene/scene.h"
#include "bench/studies/plans/option_tables.h"

namespace wobblebench::bench {

/// In TOML:
///   seeds = 10                             # number of seeds, from first_seed on
///   first_seed = 1
///   rungs = ["field", "scatterers"]
///   population = "population.toml"         # in place of scenes and seeds (DrawnOptions)
///   reference = "paper"                    # the setting that others are compared with
///   [scenes.ball]                          # as in a scene file, below its name
///   file = "sphere.toml"                   # beside the plan; a scene to begin from
///   phantom.radius_mm = 25
///   [settings.long.render.ray_casting]     # overrides, of [render] alone
///   buffer_length = 64
/// Scenes and settings are in alphabetical order, but the reference comes first. A phantom's files
/// are sought beside the plan.
struct AccuracyPlan {
  std::string source;  ///< the file, for refusals
  std::vector<std::uint64_t> seeds;
  std::vector<sim::Rung> rungs;
  std::vector<NamedOptions> scenes;
  std::vector<NamedOptions> settings;  ///< the first is the reference
  bool of_one_scene = false;           ///< which may set rung and seed by itself
  /// Of each scene of a population: its stratum and its own seed. Empty: the scenes are none.
  struct Drawn {
    std::string stratum;
    std::uint64_t seed = 0;
  };
  std::vector<Drawn> drawn = {};
};

inline constexpr int kMostSeeds = 1000;

/// Whether a file is a plan, not a scene: it has one of the plan's tables. Throws UserError.
bool is_accuracy_plan(const std::filesystem::path& path);

/// Throws UserError "FILE: key = value: what is allowed". What scenes and settings hold is not yet
/// checked.
AccuracyPlan load_accuracy_plan(const std::filesystem::path& path);

/// The plan of one scene with its own settings, on the rung that it names or would choose.
AccuracyPlan accuracy_plan_of_scene(const std::filesystem::path& path,
                                    const std::vector<std::string>& settings);

/// One scene with one setting on one rung, read and checked. `more`: settings of --set, for all.
/// Throws UserError.
Scene planned_scene(const AccuracyPlan& plan,
                    const NamedOptions& scene,
                    const NamedOptions& setting,
                    sim::Rung rung,
                    const std::vector<std::string>& more);

/// The command that makes the picture of a scene with these settings, as a shell takes it.
std::string run_command_line(const std::filesystem::path& scene,
                             const std::vector<std::string>& settings);

}  // namespace wobblebench::bench
