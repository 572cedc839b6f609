// What `run --tolerance` measures: the points that a request leaves open.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "bench/studies/tolerance/tolerance_choice.h"
#include "bench/studies/trade/trade_study.h"

namespace wobblebench::bench {

inline constexpr const char* kRungKey = "simulation.fidelity";

/// What the request alone decides, before anything is measured. Throws UserError.
class ToleranceQuestion {
 public:
  explicit ToleranceQuestion(const ToleranceRequest& request);

  /// The scene's own rung, or the finest that it allows but for `reference`, which is for small
  /// scenes alone.
  const std::string& finest_rung() const { return finest_; }
  /// That may be chosen instead, the coarsest first.
  std::vector<std::string> coarser_rungs() const;

  /// Points: each setting of the ladder on the finest rung, then on each coarser one; without those
  /// that are equal but for keys that the scene names itself.
  TradeWork work() const;

 private:
  Scene load(const std::vector<std::string>& more) const;
  std::string choose_finest_rung() const;
  std::vector<std::size_t> free_keys() const;
  TradePlan plan() const;
  TradePoint point_of(const std::vector<std::string>& values, const std::string& rung) const;

  const ToleranceRequest& request_;
  const std::set<std::string> given_;
  const std::string finest_;
};

}  // namespace wobblebench::bench
