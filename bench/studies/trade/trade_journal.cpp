#include "bench/studies/trade/trade_journal.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "bench/output/report_parts.h"
#include "bench/results/error.h"

namespace wobblebench::bench {

namespace {

constexpr const Measure* kTraded[] = {&error::kMedian,
                                      &error::kRms,
                                      &error::kP95,
                                      &error::kOutsideRms,
                                      &error::kOutsideP95,
                                      &error::kMissed,
                                      &error::kFalse,
                                      &error::kMissedOrFalse,
                                      &error::kNormalMedian,
                                      &error::kMouthP95,
                                      &error::kNoseP95,
                                      &error::kEyesP95,
                                      &error::kEarsP95};

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "wobblebench.trade.points/3";

constexpr std::pair<const char*, double EvaluationTimes::*> kEvaluationTimes[] = {
    {"evaluation_renderer_ms", &EvaluationTimes::renderer_ms},
    {"evaluation_render_ms", &EvaluationTimes::render_ms},
    {"evaluation_truth_ms", &EvaluationTimes::truth_ms},
    {"evaluation_measure_ms", &EvaluationTimes::measure_ms}};

Json json_of(const TradeRecord& record) {
  const TradeUnit& unit = record.unit;
  Json json = {{"scene", unit.scene}, {"point", unit.point}, {"seed", unit.seed}};
  json.update(measured_json(record));
  return json;
}

void add_record(const Json& line, TradeRecords& records) {
  TradeRecord record = measured_of(line);
  record.unit = {line.at("scene"), line.at("point"), line.at("seed")};
  records.emplace(record.unit, std::move(record));
}

}  // namespace

Json measured_json(const TradeRecord& record) {
  if (!record.refused.empty()) return {{"refused", record.refused}};
  Json json;
  for (std::size_t i = 0; i < record.measures.size(); ++i) {
    json[traded()[i]->key] = number(record.measures[i]);
  }
  for (const auto& [measure, time] : kTradeTimes) json[measure->key] = record.*time;
  for (const auto& [name, time] : kEvaluationTimes) json[name] = record.evaluation.*time;
  return json;
}

TradeRecord measured_of(const Json& json) {
  TradeRecord record;
  if (json.contains("refused")) {
    record.refused = json["refused"];
    return record;
  }
  for (const Measure* measure : traded()) {
    const Json& value = json.at(measure->key);
    record.measures.push_back(value.is_null() ? std::nan("") : value.get<double>());
  }
  for (const auto& [measure, time] : kTradeTimes) record.*time = json.at(measure->key);
  for (const auto& [name, time] : kEvaluationTimes) record.evaluation.*time = json.at(name);
  return record;
}

Chosen traded() {
  return kTraded;
}

std::vector<double> trade_measures(const PictureMeasures& measures) {
  std::vector<double> values;
  const Measurements found = described(measures, ExpectedSurface());
  for (const Measure* measure : kTraded) values.push_back(found.value(*measure));
  return values;
}

std::size_t trade_measure(const std::string& key) {
  const auto* const found =
      std::ranges::find(kTraded, key, [](const Measure* one) { return one->key; });
  if (found == std::end(kTraded)) throw std::out_of_range("no measure " + key);
  return static_cast<std::size_t>(found - std::begin(kTraded));
}

TradeJournal::TradeJournal(const std::filesystem::path& folder, const std::string& plan)
    : file_(folder, {kFile, kSchema, plan}, [this](const Json& line) {
        add_record(line, records_);
      }) {}

void TradeJournal::append(const TradeRecord& record) {
  if (records_.emplace(record.unit, record).second) file_.append(json_of(record));
}

std::string text_of(const TradeRecords& records) {
  std::string text;
  for (const auto& [unit, record] : records) text += json_of(record).dump() + "\n";
  return text;
}

TradeRecords trade_records(const std::string& text) {
  TradeRecords records;
  std::istringstream lines(text);
  try {
    for (std::string line; std::getline(lines, line);) add_record(Json::parse(line), records);
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("no records of a trade: ") + error.what());
  }
  return records;
}

TradeContent read_trade_journal(const std::filesystem::path& folder,
                                const std::string& plan,
                                const std::string& option) {
  TradeContent content;
  const auto take = [&](const Json& line) { add_record(line, content.records); };
  content.machines = read_journal(folder, {TradeJournal::kFile, kSchema, plan}, option, take);
  return content;
}

}  // namespace wobblebench::bench
