// The command `tune`: searches a plan's settings for the least of one quantity within limits of
// others, and confirms what it finds on seeds and scenes that the search did not see.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/command/limits.h"
#include "bench/studies/trade/trade_analysis.h"
#include "bench/studies/tune/tune_journal.h"
#include "bench/studies/tune/tune_search.h"

namespace wobblebench::bench {

using TuneLimit = Limit;

/// What `tune` is asked for.
struct TuneRequest {
  std::string least = "volume_ms";  ///< one of tune_quantities(): its mean over the scenes
  std::vector<TuneLimit> limits;
};

/// Times and measures of the picture, with their units: the keys of kTradeTimes and traded().
std::vector<std::string> tune_quantities();
/// Before a quantity's name: the mean over the scenes. Without it every scene must keep a limit.
inline constexpr std::string_view kMeanOf = "mean:";
std::string mean_of(const std::string& name);
bool is_mean(const std::string& name);
/// The one of this name, with or without kMeanOf. Throws std::out_of_range.
const Measure& quantity(const std::string& name);
/// Throws UserError "OPTION = NAME: must be one of ...".
void check_quantity(const std::string& option, const std::string& name);
/// "p95_mm<=2" or "mean:p95_mm<=2", with a number above 0. Throws UserError "--limit = TEXT: what
/// is allowed".
TuneLimit parse_limit(const std::string& text);

/// One scene's, or the mean of all: of the seeds the mean, or the bound of a further one. `name`
/// without kMeanOf.
double figure_of(const TradeFigures& of, const std::string& name, bool bound);

/// A quantity on the scene where it is greatest, or of all scenes together. NaN where one of them
/// has none.
struct Reached {
  double value = 0;
  std::optional<std::size_t> scene = {};  ///< number of the plan; none: the mean of all
};
/// The magnitude of a signed one. Throws std::out_of_range for an unknown name.
Reached quantity_of(const TradeScore& score, const std::string& name);
/// What the quantity stays below on a further seed with a probability of 95 % (upper_of_next());
/// times, which follow from the machine and not from the seed, as measured.
Reached upper_quantity(const TradeScore& score, const std::string& name);

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

/// What a limit is compared with: of fresh seeds the upper_quantity().
struct LimitValue {
  TuneLimit limit;
  Reached reached;
  bool holds() const { return reached.value <= limit.most; }
};

/// The point that came nearest to the limits where none was found.
struct TuneNearest {
  std::size_t point = 0;
  bool on_fresh_seeds = false;
  std::vector<LimitValue> values;  ///< of all limits
};

/// The chosen point on the plan's unseen scenes.
struct UnseenScenes {
  std::optional<TradeScore> score;   ///< on those that did not refuse it; none: all did
  std::vector<std::string> refused;  ///< names
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
  /// Of each limit what the chosen point reaches on the fresh seeds; empty: none was chosen.
  std::vector<LimitValue> reached() const;
  std::vector<LimitValue> reached_unseen() const;
  std::optional<TuneNearest> nearest = {};  ///< none: one was chosen, or all points were refused
  std::optional<TradeScore> judged;    ///< the chosen one on the judging seeds; none: not asked for
  UnseenScenes unseen;                 ///< empty where the plan has none
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
