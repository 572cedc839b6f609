// The scenes of a data set on disk: made one by one by `record`, `run` and `export`, each whole or
// not there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/command/common_options.h"
#include "bench/studies/dataset/population_plan.h"

namespace wobblebench::bench {

/// The folder of a data set:
///   dataset.json             which plan and program its scenes are of
///   scenes/000012/           all files of a scene, or of a refused one scene.toml and scene.json
///   scenes/000012/scene.json its line of the manifest
/// Several commands may fill one folder at the same time: each scene is locked while it is made.
class DatasetFolder {
 public:
  /// Makes the folder where it is missing. Throws UserError "--out = DIR: reason", also for one
  /// with scenes of another plan, or of another program where scenes are to be added.
  DatasetFolder(std::filesystem::path folder, const PopulationPlan& plan, bool adds_scenes = true);

  std::filesystem::path scene(int index) const;
  bool has(int index) const;
  /// The line of a scene that is there. Throws std::runtime_error where it cannot be read.
  nlohmann::ordered_json line(int index) const;
  const std::filesystem::path& path() const { return folder_; }

 private:
  void check_head(const PopulationPlan& plan, bool adds_scenes) const;

  std::filesystem::path folder_;
};

/// How scenes are made.
struct SceneMaking {
  std::string gl = "auto";
  CacheArguments cache;
};

enum class SceneOutcome { made, refused, in_other_hands };

/// Makes one scene, which must not be there. Throws std::runtime_error where the machine could not
/// do it, and UserError for a refusal that is not of the scene.
SceneOutcome make_scene(const PopulationPlan& plan,
                        int index,
                        const SceneMaking& how,
                        const DatasetFolder& folder);

/// Makes a scene again beside the data set. Returns a line for each file that differs.
std::vector<std::string> verify_scene(const PopulationPlan& plan,
                                      int index,
                                      const SceneMaking& how,
                                      const DatasetFolder& folder);

/// `most` of the scenes that are there, in an order that follows from the plan's seed alone.
std::vector<int> scenes_to_verify(const PopulationPlan& plan,
                                  const DatasetFolder& folder,
                                  std::size_t most);

/// Whether a line of a refusal is about the scene, and not about the program's arguments.
bool is_refusal_of_scene(const std::string& line);

}  // namespace wobblebench::bench
