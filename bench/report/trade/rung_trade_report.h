// Speed against accuracy of the simulator's rungs, as trade.md, trade.csv, report.json and figures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/report/figure.h"
#include "bench/report/provenance.h"
#include "bench/studies/trade/rung_comparison.h"

namespace wobblebench::bench {

std::vector<Figure> trade_figures(const RungTradeResults& results);

/// File of a figure.
std::string trade_figure_file(const Figure& figure);

std::string trade_markdown(const RungTradeResults& results, const Provenance& provenance);
std::string trade_csv(const RungTradeResults& results);

/// "trade": points with settings, time and error, and which of them lie on the Pareto front.
nlohmann::ordered_json trade_json(const RungTradeResults& results);

}  // namespace wobblebench::bench
