// The plan of the command `dataset`: a population of scenes, drawn from distributions and strata.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bench/scene/scene.h"
#include "bench/studies/dataset/distribution.h"

namespace wobblebench::bench {

/// A part of the scenes, and what its options are.
struct Stratum {
  std::string name;
  int scenes = 0;
  std::map<std::string, Distribution> options;  ///< by section.key, those of [scene] too
};

/// One scene of a population.
struct DrawnScene {
  int index = 0;
  std::size_t stratum = 0;
  std::vector<std::string> settings;  ///< section.key=value, as load_scene() takes them
  /// The value of an option, as in TOML; empty: it has none.
  std::string value(const std::string& key) const;
};

/// In TOML:
///   scenes = 1000                          # left out where each stratum has a count
///   seed = 1                               # of the draws
///   exports = ["polar.npz,content=polar"]  # files of `export` for each scene
///   pages = false                          # whether each scene keeps its report.html
///   [scene]                                # options of every scene, as in a scene file
///   file = "face.toml"                     # beside the plan; a scene to begin from
///   phantom.identity = { integers = [1, 1000000] }
///   phantom.gestational_age_weeks = { uniform = [20, 34] }
///   phantom.head_yaw_deg = { normal = [0, 20], within = [-40, 40] }
///   phantom.hand = { choice = ["beside", "before"], weights = [3, 1] }
///   [strata.cleft]                         # options in place of those of [scene]
///   share = 0.2                            # or count = 200
///   phantom.cleft_width_mm = { uniform = [1, 4] }
/// Without strata all scenes are of one, "all". simulation.seed is drawn unless it is given.
struct PopulationPlan {
  std::string source;          ///< the file, for refusals
  std::filesystem::path file;  ///< the scene that [scene] begins from; empty: the defaults
  int scenes = 0;
  std::uint64_t seed = 1;
  std::vector<std::string> exports;
  bool pages = false;
  std::vector<Stratum> strata;
  std::vector<std::size_t> stratum_of;  ///< of each scene

  DrawnScene draw(int index) const;
  /// Throws UserError.
  Scene scene(const DrawnScene& drawn) const;
  /// SHA-256 of all that the scenes follow from: the plan, the scene that it begins from, and the
  /// files of phantoms.
  std::string hash() const;
};

inline constexpr int kMostScenes = 1'000'000;

/// Reads the plan and draws scenes of each stratum, which are read and checked. Throws UserError
/// "FILE: key: what is allowed".
PopulationPlan load_population_plan(const std::filesystem::path& path);

/// One line that names options which are without effect in all scenes that were looked at; empty:
/// there are none.
std::string idle_options_of(const PopulationPlan& plan);

/// The stratum of each scene: spread over the scenes as uniformly as can be, so that each stretch
/// of them has the shares of all. `counts`: scenes of each stratum.
std::vector<std::size_t> spread_strata(const std::vector<int>& counts);

/// The halves of a population: of each stratum every second scene. No child and no speckle is in
/// both.
enum class PopulationHalf { train, judge };

/// The first scenes of each stratum in a half, at most `per_stratum` of them, in the order of their
/// numbers. Throws UserError "SOURCE: …" where one identity or seed is in both halves, or two of
/// the scenes that are returned are of one stratum and seed.
std::vector<DrawnScene> scenes_of_half(const PopulationPlan& plan,
                                       PopulationHalf half,
                                       int per_stratum);

/// Numbers of scenes whose sum is `scenes`, as near to the shares as can be (largest remainders).
std::vector<int> counts_of_shares(const std::vector<double>& shares, int scenes);

}  // namespace wobblebench::bench
