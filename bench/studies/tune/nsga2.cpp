#include "bench/studies/tune/nsga2.h"

#include <algorithm>
#include <numeric>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>

namespace wobblebench::bench {

namespace {

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
  const SearchFunction* function = nullptr;

  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    const SearchValue value = (*function)(order->ours(x));
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

}  // namespace

bool has_nsga2() {
  return true;
}

void breed_nsga2(const std::vector<SearchAxis>& axes,
                 const std::vector<SearchPoint>& population,
                 std::uint64_t seed,
                 const SearchFunction& function,
                 const std::function<bool()>& goes_on) {
  const Order order(axes);
  const auto pagmo_seed = static_cast<unsigned>(seed);
  pagmo::population generation(pagmo::problem(Problem{&order, &function}), 0U, pagmo_seed);
  for (const SearchPoint& point : population) generation.push_back(order.theirs(point));
  // One level of one axis more or less is a neighbour: mutation of about one axis a child.
  const double mutation = 1.0 / static_cast<double>(population.front().size());
  const pagmo::algorithm algorithm(pagmo::nsga2(1, 0.9, 10, mutation, 20, pagmo_seed));
  while (goes_on()) generation = algorithm.evolve(generation);
}

}  // namespace wobblebench::bench
