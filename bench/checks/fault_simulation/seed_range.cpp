#include "bench/checks/fault_simulation/seed_range.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <utility>

#include "bench/checks/fault_simulation/oracle.h"

namespace wobblebench::bench {

namespace {

void add(hw::BoardAccount& sum, const hw::BoardAccount& account) {
  sum.emitted += account.emitted;
  sum.delivered += account.delivered;
  sum.lost.ring_full += account.lost.ring_full;
  sum.lost.link += account.lost.link;
  sum.lost.corrupt += account.lost.corrupt;
  sum.lost.out_of_order += account.lost.out_of_order;
  sum.duplicates += account.duplicates;
}

}  // namespace

SeedRangeResult simulate_seeds(std::uint64_t first_seed, int seeds, const PartDone& done) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<FaultSimulationResult> results(static_cast<std::size_t>(seeds));
  std::atomic<std::size_t> finished = 0;
  tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
    results[i] = simulate_faults(first_seed + i);
    const std::size_t count = ++finished;
    if (done) done(count, results.size());
  });
  SeedRangeResult all{.first_seed = first_seed, .seeds = seeds};
  all.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EventHash hash;
  for (FaultSimulationResult& result : results) {
    hash.add(result.hash);
    all.device_time_s += result.device_time_s;
    all.acquired_s += result.acquired_s;
    all.steps += result.steps;
    all.sticks += result.sticks_emitted;
    add(all.account, result.account);
    if (!result.failure.empty()) all.failed.push_back(std::move(result));
  }
  all.hash = hash.value();
  return all;
}

}  // namespace wobblebench::bench
