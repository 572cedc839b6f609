// What `tune` is asked for: the least of one quantity within limits of others.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/trade/trade_analysis.h"

namespace wobblebench::bench {

struct TuneLimit {
  std::string name;
  double most = 0;
};

struct TuneRequest {
  std::string least = "volume_ms";  ///< of tune_quantities()
  std::vector<TuneLimit> limits;
};

/// Times and measures of the picture, with their units: volume_ms, view_ms, volume_ratio,
/// view_ratio, and trade_measure_names().
const std::vector<std::string>& tune_quantities();
/// Throws UserError "OPTION = NAME: must be one of ...".
void check_quantity(const std::string& option, const std::string& name);
/// "p95_mm<=2". Throws UserError "--limit = TEXT: what is allowed".
TuneLimit parse_limit(const std::string& text);

/// Of median_mm the magnitude. Throws std::out_of_range for an unknown name.
double quantity_of(const TradeScore& score, const std::string& name);
/// What the quantity stays below on a further seed with a probability of 95 % (upper_of_next());
/// times, which follow from the machine and not from the seed, as measured.
double upper_quantity(const TradeScore& score, const std::string& name);

/// Sum over the limits of the parts by which they are exceeded; 0: all hold. 1e6 where a quantity
/// is not formed, as where no surface is found.
double excess_of(const TuneRequest& request, const TradeScore& score);

}  // namespace wobblebench::bench
