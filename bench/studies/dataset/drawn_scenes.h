// Scenes of a population in place of those that a plan names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/options.h"
#include "bench/studies/dataset/population_plan.h"
#include "bench/studies/plans/option_tables.h"

namespace wobblebench::bench {

inline constexpr int kMostPerStratum = 1000;

/// In TOML:
///   population = "population.toml"         # a plan of `dataset`, beside this one
///   half = "judge"                         # or "train"
///   per_stratum = 10                       # the first scenes of each stratum in that half
struct DrawnOptions {
  std::string population;  ///< empty: the plan names its scenes
  PopulationHalf half = PopulationHalf::judge;
  int per_stratum = 10;

  bool given() const { return !population.empty(); }
};

template <OptionsOf<DrawnOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.text("population", o.population);
  v.choice("half", o.half, {{"train", PopulationHalf::train}, {"judge", PopulationHalf::judge}});
  v.integer("per_stratum", o.per_stratum, 1, kMostPerStratum);
}

/// Refuses `half` and `per_stratum` without a population, and beside one the keys of
/// `drawn_instead`. `given`: keys that stand in the plan.
void check_drawn_keys(const DrawnOptions& options,
                      const std::vector<std::string>& given,
                      const std::vector<std::string>& drawn_instead,
                      const std::string& source);

/// A scene without its seed, which a study sets.
struct NamedDrawnScene {
  NamedOptions scene;  ///< named STRATUM-NUMBER
  std::string stratum;
  std::uint64_t seed = 0;
};

/// `plan`: the file in which the options stand. Throws UserError.
std::vector<NamedDrawnScene> drawn_scenes(const DrawnOptions& options,
                                          PopulationHalf half,
                                          const std::filesystem::path& plan);

}  // namespace wobblebench::bench
