#include "bench/studies/dataset/drawn_scenes.h"

#include <algorithm>

namespace wobblebench::bench {

void check_drawn_keys(const DrawnOptions& options,
                      const std::vector<std::string>& given,
                      const std::vector<std::string>& drawn_instead,
                      const std::string& source) {
  const std::vector<std::string> acting_with_one = {"half", "per_stratum"};
  for (const std::string& key : options.given() ? drawn_instead : acting_with_one) {
    if (std::ranges::find(given, key) == given.end()) continue;
    refuse_plan(source,
                key,
                options.given() ? "is drawn by the population; leave it out"
                                : "acts with population alone");
  }
}

std::vector<NamedDrawnScene> drawn_scenes(const DrawnOptions& options,
                                          PopulationHalf half,
                                          const std::filesystem::path& plan) {
  const PopulationPlan population = load_population_plan(plan.parent_path() / options.population);
  const std::string seed_key = "simulation.seed=";
  std::vector<NamedDrawnScene> scenes;
  for (DrawnScene& drawn : scenes_of_half(population, half, options.per_stratum)) {
    const std::string& stratum = population.strata[drawn.stratum].name;
    const std::uint64_t seed = std::stoull(drawn.value("simulation.seed"));
    std::erase_if(drawn.settings,
                  [&](const std::string& setting) { return setting.starts_with(seed_key); });
    scenes.push_back(
        {{stratum + "-" + std::to_string(drawn.index), population.file, std::move(drawn.settings)},
         stratum,
         seed});
  }
  return scenes;
}

}  // namespace wobblebench::bench
