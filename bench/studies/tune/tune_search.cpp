#include "bench/studies/tune/tune_search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <random>
#include <utility>

#include "base/hash.h"

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

/// pagmo counts continuous variables first.
class Order {
 public:
  explicit Order(const std::vector<SearchAxis>& axes) : axes_(axes), order_(axes.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_partition(
        order_.begin(), order_.end(), [&](std::size_t i) { return axes[i].levels == 0; });
  }

  pagmo::vector_double theirs(const SearchPoint& point) const {
    pagmo::vector_double result;
    for (const std::size_t i : order_) result.push_back(point[i]);
    return result;
  }
  SearchPoint ours(const pagmo::vector_double& point) const {
    SearchPoint result(point.size());
    for (std::size_t i = 0; i < order_.size(); ++i) result[order_[i]] = point[i];
    return result;
  }
  pagmo::vector_double upper() const {
    pagmo::vector_double result;
    for (const std::size_t i : order_) {
      result.push_back(axes_[i].levels == 0 ? 1 : axes_[i].levels - 1);
    }
    return result;
  }
  std::size_t integers() const {
    return static_cast<std::size_t>(
        std::count_if(axes_.begin(), axes_.end(), [](auto& axis) { return axis.levels > 0; }));
  }

 private:
  const std::vector<SearchAxis>& axes_;
  std::vector<std::size_t> order_;
};

/// The problem as pagmo takes it; pagmo copies it.
struct Problem {
  const Order* order = nullptr;
  Evaluations* evaluations = nullptr;

  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    const SearchValue value = evaluations->of(order->ours(x));
    return {value.goal, value.excess};
  }
  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    auto upper = order->upper();
    pagmo::vector_double lower(upper.size(), 0);
    return {std::move(lower), std::move(upper)};
  }
  pagmo::vector_double::size_type get_nobj() const { return 2; }
  pagmo::vector_double::size_type get_nix() const { return order->integers(); }
};

SearchPoint random_point(const std::vector<SearchAxis>& axes, std::mt19937_64& random) {
  SearchPoint point;
  for (const SearchAxis& axis : axes) {
    const double share = unit_interval(random());
    point.push_back(axis.levels == 0 ? share : std::floor(share * axis.levels));
  }
  return point;
}

void search_nsga2(const Order& order,
                  std::vector<SearchPoint> population,
                  const SearchOptions& options,
                  Evaluations& evaluations) {
  const auto seed = static_cast<unsigned>(options.seed);
  pagmo::population generation(pagmo::problem(Problem{&order, &evaluations}), 0U, seed);
  for (const SearchPoint& point : population) generation.push_back(order.theirs(point));
  // One level of one axis more or less is a neighbour: mutation of about one axis a child.
  const double mutation = 1.0 / static_cast<double>(population.front().size());
  const pagmo::algorithm algorithm(pagmo::nsga2(1, 0.9, 10, mutation, 20, seed));
  for (int idle = 0; evaluations.left() > 0 && idle < kIdleGenerations;) {
    const int before = evaluations.left();
    generation = algorithm.evolve(generation);
    idle = evaluations.left() == before ? idle + 1 : 0;
  }
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
  const Order order(axes);
  search_nsga2(order, std::move(population), options, evaluations);
}

}  // namespace wobblebench::bench
