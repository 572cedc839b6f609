// The command `tune`: searches a plan's settings for the least of one quantity within limits of
// others, and confirms what it finds on seeds and scenes that the search did not see.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/command/limits.h"
#include "bench/studies/trade/trade_analysis.h"
#include "bench/studies/tune/tune_journal.h"
#include "bench/studies/tune/tune_search.h"

namespace wobblebench::bench {

using TuneLimit = Limit;

/// What `tune` is asked for.
struct TuneRequest {
  std::string least = "volume_ms";  ///< one of tune_quantities()
  std::vector<TuneLimit> limits;
};

/// Times and measures of the picture, with their units: the keys of kTradeTimes and traded().
std::vector<std::string> tune_quantities();
/// The one of this key. Throws std::out_of_range.
const Measure& quantity(const std::string& name);
/// Throws UserError "OPTION = NAME: must be one of ...".
void check_quantity(const std::string& option, const std::string& name);
/// "p95_mm<=2", with a number above 0. Throws UserError "--limit = TEXT: what is allowed".
TuneLimit parse_limit(const std::string& text);

/// The magnitude of a signed one. Throws std::out_of_range for an unknown name.
double quantity_of(const TradeScore& score, const std::string& name);
/// What the quantity stays below on a further seed with a probability of 95 % (upper_of_next());
/// times, which follow from the machine and not from the seed, as measured.
double upper_quantity(const TradeScore& score, const std::string& name);

/// Sum over the limits of the relative excess, value / limit - 1; 0: all hold. 1e6 where a quantity
/// is not formed, as where no surface is found.
double excess_of(const TuneRequest& request, const TradeScore& score);

struct TuneOptions {
  TuneRequest request;
  SearchOptions search;
  int fresh_seeds = 3;    ///< after the plan's; 2 at least
  int judging_seeds = 0;  ///< after those: the chosen point is measured on them, and not changed
};

/// A point that met the limits on the plan's seeds.
struct TuneCandidate {
  std::size_t point = 0;
  TradeScore searched;              ///< on the plan's seeds
  std::optional<TradeScore> fresh;  ///< on fresh seeds; none: refused there
  bool holds = false;               ///< each limit, for the upper_quantity() of the fresh seeds
};

/// The point that came nearest to the limits where none was found.
struct TuneNearest {
  /// As compared with a limit: of fresh seeds the upper_quantity().
  struct Value {
    TuneLimit limit;
    double value = 0;
  };
  std::size_t point = 0;
  bool on_fresh_seeds = false;
  std::vector<Value> values;  ///< of all limits
};

struct UnseenScore {
  std::string scene;
  std::optional<TradeScore> score;
};

struct TuneResults {
  TradeWork work;  ///< with the points that were tried
  TuneOptions options;
  std::vector<std::uint64_t> fresh_seeds;
  std::size_t known = 0;                  ///< points of the trade that was given
  std::size_t evaluated = 0;              ///< points that were measured besides
  std::size_t refused = 0;                ///< of those
  std::vector<TuneCandidate> candidates;  ///< in the order in which they were tried
  /// The candidate that holds, which is the last; none: nothing was found.
  const TuneCandidate* chosen() const;
  std::optional<TuneNearest> nearest = {};  ///< none: one was chosen, or all points were refused
  std::optional<TradeScore> judged;    ///< the chosen one on the judging seeds; none: not asked for
  std::vector<UnseenScore> unseen;     ///< the chosen one on the plan's unseen scenes
  std::vector<std::string> at_an_end;  ///< keys whose chosen value is the first or last of the plan
};

inline constexpr std::size_t kMostCandidates = 8;

/// `known`: records of `work`'s points. `kept`: whose measurements are not made again, and where
/// new ones are kept. Throws std::runtime_error; UserError where the reference is refused.
TuneResults tune(TradeWork work,
                 const TuneOptions& options,
                 TradeRecords known,
                 KeptSearch kept,
                 render::GlContext& context,
                 PhantomCache& cache,
                 const PartDone& done);

/// Keys of numbers whose value is the least or the greatest that the plan has, 3 % of a range's
/// ends included.
std::vector<std::string> keys_at_an_end(const TradePlan& plan, const TradePoint& point);

}  // namespace wobblebench::bench
