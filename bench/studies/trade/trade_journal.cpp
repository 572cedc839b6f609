#include "bench/studies/trade/trade_journal.h"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "base/file.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

/// Over the pixels outside the band at silhouettes, in mm.
double outside(const PictureMeasures& measures, double DepthStatistics::*member) {
  for (const RegionError& region : measures.regions) {
    if (region.group != "silhouette" || region.name != "outside") continue;
    return region.depth.*member / kMillimetre;
  }
  return kUnset;
}

using Column = std::pair<std::string, std::function<double(const PictureMeasures&)>>;

const std::vector<Column>& columns() {
  using M = const PictureMeasures&;
  static const std::vector<Column> all = {
      {"median_mm", [](M m) { return m.raw.depth.median_m / kMillimetre; }},
      {"rms_mm", [](M m) { return m.raw.depth.rms_m / kMillimetre; }},
      {"p95_mm", [](M m) { return m.raw.depth.p95_m / kMillimetre; }},
      {"outside_rms_mm", [](M m) { return outside(m, &DepthStatistics::rms_m); }},
      {"outside_p95_mm", [](M m) { return outside(m, &DepthStatistics::p95_m); }},
      {"missed_percent", [](M m) { return m.raw.missed_percent(); }},
      {"false_percent", [](M m) { return m.raw.false_percent(); }},
      {"missed_or_false_percent",
       [](M m) { return m.raw.missed_percent() + m.raw.false_percent(); }},
      {"normal_median_deg", [](M m) { return m.filtered.normal.median_rad / kDegree; }}};
  return all;
}

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "wobblebench.trade.points/1";

/// Journals of earlier versions have none.
constexpr std::pair<const char*, double EvaluationTimes::*> kEvaluationTimes[] = {
    {"evaluation_renderer_ms", &EvaluationTimes::renderer_ms},
    {"evaluation_render_ms", &EvaluationTimes::render_ms},
    {"evaluation_truth_ms", &EvaluationTimes::truth_ms},
    {"evaluation_measure_ms", &EvaluationTimes::measure_ms}};

Json json_of(const TradeRecord& record) {
  const TradeUnit& unit = record.unit;
  Json json = {{"scene", unit.scene}, {"point", unit.point}, {"seed", unit.seed}};
  if (!record.refused.empty()) {
    json["refused"] = record.refused;
    return json;
  }
  for (std::size_t i = 0; i < record.measures.size(); ++i) {
    json[trade_measure_names()[i]] = number(record.measures[i]);
  }
  for (const auto& [name, time] : kTradeTimes) json[name] = record.*time;
  for (const auto& [name, time] : kEvaluationTimes) json[name] = record.evaluation.*time;
  return json;
}

TradeRecord record_of(const Json& json) {
  TradeRecord record;
  record.unit = {json.at("scene"), json.at("point"), json.at("seed")};
  if (json.contains("refused")) {
    record.refused = json["refused"];
    return record;
  }
  for (const std::string& name : trade_measure_names()) {
    const Json& value = json.at(name);
    record.measures.push_back(value.is_null() ? std::nan("") : value.get<double>());
  }
  for (const auto& [name, time] : kTradeTimes) record.*time = json.at(name);
  for (const auto& [name, time] : kEvaluationTimes) record.evaluation.*time = json.value(name, 0.0);
  return record;
}

std::string head_of(const std::string& plan) {
  return Json({{"schema", kSchema}, {"plan", plan}}).dump() + "\n";
}

struct Content {
  TradeContent content;
  std::size_t whole = 0;  ///< bytes up to the end of the last whole line
};

void add_line(const Json& line, TradeContent& content) {
  if (line.contains("machine")) {
    content.machines.insert(line["machine"].get<std::string>());
    return;
  }
  TradeRecord record = record_of(line);
  content.records.emplace(record.unit, std::move(record));
}

/// `refuse(reason)` throws.
template <class Refuse>
Content read(const std::filesystem::path& path, const std::string& plan, const Refuse& refuse) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  Content content;
  const std::size_t end = text.rfind('\n');
  if (end == std::string::npos) return content;
  content.whole = end + 1;
  const std::string head = head_of(plan);
  if (!text.starts_with(head)) refuse("holds the points of another plan");
  int line = 1;
  for (std::size_t at = head.size(); at < content.whole; at = text.find('\n', at) + 1) {
    ++line;
    try {
      add_line(Json::parse(text.substr(at, text.find('\n', at) - at)), content.content);
    } catch (const Json::exception&) {
      refuse("line " + std::to_string(line) + " is no measured point");
    }
  }
  return content;
}

[[noreturn]] void fail(const std::filesystem::path& path) {
  throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(errno));
}

void write_whole(int file, const std::string& text, const std::filesystem::path& path) {
  if (!write_all(file, text) || sync_data(file) != 0) fail(path);
}

}  // namespace

const std::vector<std::string>& trade_measure_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const auto& [name, value] : columns()) result.push_back(name);
    return result;
  }();
  return names;
}

std::vector<double> trade_measures(const PictureMeasures& measures) {
  std::vector<double> values;
  for (const auto& [name, value] : columns()) {
    values.push_back(measures.raw.surface_in_view() ? value(measures) : kUnset);
  }
  return values;
}

std::size_t trade_measure(const std::string& name) {
  const auto& names = trade_measure_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw std::out_of_range("no measure " + name);
  return static_cast<std::size_t>(found - names.begin());
}

TradeJournal::TradeJournal(const std::filesystem::path& folder, const std::string& plan)
    : path_(folder / kFile) {
  Content content = read(path_, plan, [&](const std::string& reason) {
    throw UserError("--out = " + folder.string() + ": " + kFile + " " + reason +
                    "; give another folder");
  });
  file_ = FileDescriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (!file_.is_open() || ::ftruncate(file_.get(), static_cast<off_t>(content.whole)) != 0) {
    fail(path_);
  }
  if (content.whole == 0) {
    write_whole(file_.get(), head_of(plan), path_);
    sync_folder(folder);
  }
  content_ = std::move(content.content);
}

void TradeJournal::append(const TradeRecord& record) {
  if (!content_.records.emplace(record.unit, record).second) return;
  write_whole(file_.get(), json_of(record).dump() + "\n", path_);
}

void TradeJournal::append_machine(const std::string& machine) {
  if (!content_.machines.insert(machine).second) return;
  write_whole(file_.get(), Json({{"machine", machine}}).dump() + "\n", path_);
}

std::string text_of(const TradeRecords& records) {
  std::string text;
  for (const auto& [unit, record] : records) text += json_of(record).dump() + "\n";
  return text;
}

TradeRecords trade_records(const std::string& text) {
  TradeContent content;
  std::istringstream lines(text);
  try {
    for (std::string line; std::getline(lines, line);) add_line(Json::parse(line), content);
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("no records of a trade: ") + error.what());
  }
  return std::move(content.records);
}

TradeContent read_trade_journal(const std::filesystem::path& folder,
                                const std::string& plan,
                                const std::string& option) {
  const auto refuse = [&](const std::string& reason) {
    throw UserError(option + " = " + folder.string() + ": " + reason);
  };
  const std::filesystem::path path = folder / TradeJournal::kFile;
  if (!std::filesystem::is_regular_file(path)) {
    refuse(std::string("has no ") + TradeJournal::kFile);
  }
  return read(path,
              plan,
              [&](const std::string& reason) {
                refuse(std::string(TradeJournal::kFile) + " " + reason);
              })
      .content;
}

}  // namespace wobblebench::bench
