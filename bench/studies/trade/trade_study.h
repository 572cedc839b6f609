// The measurements of the command `trade`: time and error of every point of a plan.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "bench/cache/phantom_cache.h"
#include "bench/studies/trade/trade_journal.h"
#include "bench/studies/trade/trade_plan.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// A plan with its points, and the scenes that they make.
struct TradeWork {
  TradePlan plan;
  std::vector<TradePoint> points;
  std::vector<std::string> more;  ///< settings for all, after those of the scene

  /// The scene as a point sets it. Throws UserError.
  Scene scene(std::size_t scene, const TradePoint& point) const;
  Scene reference(std::size_t scene) const;
  /// A hash of all that the records follow from.
  std::string hash() const;
};

/// Reads each scene with its reference, and with each level of each axis alone. Throws UserError.
void check_trade(const TradeWork& work);

/// Every measurement, in the order of the work: what shares sticks and slices follows each other.
std::vector<TradeUnit> trade_units(const TradeWork& work);

/// Part `index` of `count`, from 1 on: a stretch of the work.
std::vector<TradeUnit> trade_shard(const std::vector<TradeUnit>& units, int index, int count);

/// Measures what is not in the journal yet. A combination of settings that the scene, the simulator
/// or the renderer refuses is a record that says so.
void measure_trade(const TradeWork& work,
                   const std::vector<TradeUnit>& units,
                   TradeJournal& journal,
                   render::GlContext& context,
                   PhantomCache& cache,
                   const PartDone& done = {});

}  // namespace wobblebench::bench
