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
///   seeds = 10                             # so many, from first_seed on
///   first_seed = 1
///   rungs = ["field", "scatterers"]
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
};

inline constexpr int kMostSeeds = 1000;

/// Whether a file is a plan, not a scene: it has one of the plan's tables. Throws UserError.
bool is_accuracy_plan(const std::filesystem::path& path);

/// Throws UserError "FILE: key = value: what is allowed". What scenes and settings hold is not yet
/// looked at.
AccuracyPlan load_accuracy_plan(const std::filesystem::path& path);

/// Of one scene and its own settings: the scene's rung, or the one that it would choose.
AccuracyPlan accuracy_plan_of_scene(const std::filesystem::path& path,
                                    const std::vector<std::string>& settings);

/// The settings of a plan, or of a file that has nothing else. Throws UserError.
std::vector<NamedOptions> load_settings(const std::filesystem::path& path);

/// Seeds `first` and so many after it.
std::vector<std::uint64_t> seed_list(std::uint64_t first, int count);

/// One scene with one setting on one rung, read and checked. `more`: of --set, for all.
/// Throws UserError.
Scene planned_scene(const AccuracyPlan& plan,
                    const NamedOptions& scene,
                    const NamedOptions& setting,
                    sim::Rung rung,
                    const std::vector<std::string>& more);

}  // namespace wobblebench::bench
