#include "bench/board_checks/fault_simulation/seed_range.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <utility>

#include "bench/board_checks/fault_simulation/oracle.h"

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

/// Seeds that are simulated together: what they return is kept until they are added up.
constexpr int kBlock = 4096;

void add(SeedRangeResult& all, EventHash& hash, FaultSimulationResult&& result) {
  hash.add(result.hash);
  all.device_time_s += result.device_time_s;
  all.acquired_s += result.acquired_s;
  all.steps += result.steps;
  all.sticks += result.sticks_emitted;
  add(all.account, result.account);
  all.bytes_recorded += result.bytes_recorded;
  all.sticks_salvaged += result.sticks_salvaged;
  if (!result.failure.empty()) all.failed.push_back(std::move(result));
}

}  // namespace

SeedRangeResult simulate_seeds(std::uint64_t first_seed, int seeds, const PartDone& done) {
  const auto start = std::chrono::steady_clock::now();
  std::atomic<std::size_t> finished = 0;
  SeedRangeResult all{.first_seed = first_seed, .seeds = seeds};
  EventHash hash;
  for (int first = 0; first < seeds; first += kBlock) {
    std::vector<FaultSimulationResult> block(
        static_cast<std::size_t>(std::min(kBlock, seeds - first)));
    tbb::parallel_for(std::size_t{0}, block.size(), [&](std::size_t i) {
      block[i] = simulate_faults(first_seed + static_cast<std::uint64_t>(first) + i);
      const std::size_t count = ++finished;
      if (done) done(count, static_cast<std::size_t>(seeds));
    });
    for (FaultSimulationResult& result : block) add(all, hash, std::move(result));
  }
  all.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  all.hash = hash.value();
  return all;
}

}  // namespace wobblebench::bench
