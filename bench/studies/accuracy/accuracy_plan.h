// The plan of the command `accuracy`: scenes, rungs, render settings and seeds, by name.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// A table of options, as load_scene() takes them.
struct NamedOptions {
  std::string name;
  std::filesystem::path file;         ///< a scene to begin from; empty: the defaults
  std::vector<std::string> settings;  ///< section.key=value
};

/// In TOML:
///   seeds = 10                             # number of seeds, from first_seed on
///   first_seed = 1
///   rungs = ["field", "scatterers"]
///   population = "population.toml"         # in place of scenes and seeds: a plan of `dataset`
///   half = "judge"                         # or "train": which of its scenes
///   per_stratum = 10                       # how many of each stratum
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

/// Throws UserError "SOURCE: KEY: ALLOWED".
[[noreturn]] void refuse_plan(const std::string& source,
                              const std::string& key,
                              const std::string& allowed);

/// Refuses the first of `given`, the keys of a plan, that is not one of `known`.
void refuse_unknown_keys(const std::vector<std::string>& given,
                         const std::vector<std::string>& known,
                         const std::string& source);

/// The tables [KEY.NAME] of a plan, one or more. Where KEY is "settings" they hold [render] alone.
/// Throws UserError.
std::vector<NamedOptions> load_option_tables(const std::filesystem::path& path,
                                             const std::string& key);

/// The table [KEY] of a plan, without settings where the plan has none. Throws UserError.
NamedOptions load_option_table(const std::filesystem::path& path, const std::string& key);

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

/// A value without the quotes of TOML's texts.
std::string plain_value(const std::string& value);

/// The command that makes the picture of a scene with these settings, as a shell takes it.
std::string run_command_line(const std::filesystem::path& scene,
                             const std::vector<std::string>& settings);

}  // namespace wobblebench::bench
