#include "bench/studies/tune/tune_search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "base/hash.h"
#include "bench/studies/tune/nsga2.h"

namespace wobblebench::bench {

namespace {

static_assert(kSearchPopulation % 4 == 0);  // as pagmo's nsga2 asks
constexpr int kIdleGenerations = 20;        // without a new point: what is left to find is known
constexpr double kNever = 1e12;             // value of points that are not evaluated any more

/// Each point once, as many as are allowed.
class Evaluations {
 public:
  Evaluations(int most, const SearchFunction& function) : left_(most), function_(function) {}

  SearchValue of(const SearchPoint& point) {
    const auto found = known_.find(point);
    if (found != known_.end()) return found->second;
    if (left_ == 0) return {kNever, kNever};
    --left_;
    return known_.emplace(point, function_(point)).first->second;
  }
  int left() const { return left_; }

 private:
  int left_;
  const SearchFunction& function_;
  std::map<SearchPoint, SearchValue> known_;
};

SearchPoint random_point(const std::vector<SearchAxis>& axes, std::mt19937_64& random) {
  SearchPoint point;
  for (const SearchAxis& axis : axes) {
    const double share = unit_interval(random());
    point.push_back(axis.levels == 0 ? share : std::floor(share * axis.levels));
  }
  return point;
}

void search_nsga2(const std::vector<SearchAxis>& axes,
                  const std::vector<SearchPoint>& population,
                  const SearchOptions& options,
                  Evaluations& evaluations) {
  int idle = 0, before = -1;
  breed_nsga2(
      axes,
      population,
      options.seed,
      [&](const SearchPoint& point) { return evaluations.of(point); },
      [&] {
        idle = evaluations.left() == before ? idle + 1 : 0;
        before = evaluations.left();
        return before > 0 && idle < kIdleGenerations;
      });
}

}  // namespace

void search(const std::vector<SearchAxis>& axes,
            const std::vector<SearchPoint>& starts,
            const SearchOptions& options,
            const SearchFunction& function) {
  Evaluations evaluations(options.evaluations, function);
  std::mt19937_64 random(options.seed);
  if (options.method == SearchMethod::random) {
    for (int tries = 0; evaluations.left() > 0 && tries < 100 * options.evaluations; ++tries) {
      evaluations.of(random_point(axes, random));
    }
    return;
  }
  std::vector<SearchPoint> population(starts.begin(),
                                      starts.begin() + std::min(starts.size(), kSearchPopulation));
  while (population.size() < kSearchPopulation) population.push_back(random_point(axes, random));
  search_nsga2(axes, population, options, evaluations);
}

}  // namespace wobblebench::bench
