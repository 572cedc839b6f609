#include <cmath>
#include <sstream>

#include "base/number_text.h"
#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kDigits = 7;

std::string cell(double value) {
  return std::isfinite(value) ? significant(value, kDigits) : "";
}

/// In quotes where it must be, each quote of its own doubled (RFC 4180).
std::string text_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

}  // namespace

std::string trade_csv(const TradeResults& results) {
  const TradePlan& plan = results.work.plan;
  std::ostringstream csv;
  csv << "scene,point,seed";
  for (const TradeAxis& axis : plan.axes) csv << "," << axis.key;
  for (const std::string& name : trade_measure_names()) csv << "," << name;
  csv << ",refused,volume_ms,view_ms,volume_ratio,view_ratio\n";
  for (const auto& [unit, record] : results.records) {
    csv << plan.scenes[unit.scene].name << "," << unit.point << "," << plan.seeds[unit.seed];
    for (const std::string& value : results.work.points[unit.point].values) {
      csv << "," << text_cell(plain_value(value));
    }
    if (!record.refused.empty()) {
      csv << std::string(trade_measure_names().size(), ',') << "," << text_cell(record.refused)
          << ",,,,\n";
      continue;
    }
    for (const double value : record.measures) csv << "," << cell(value);
    csv << ",";
    for (const double time :
         {record.volume_ms, record.view_ms, record.volume_ratio, record.view_ratio}) {
      csv << "," << cell(time);
    }
    csv << "\n";
  }
  return csv.str();
}

}  // namespace wobblebench::bench
