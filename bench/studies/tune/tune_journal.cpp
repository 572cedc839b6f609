#include "bench/studies/tune/tune_journal.h"

#include <nlohmann/json.hpp>
#include <utility>

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "wobblebench.tune.points/2";

TuneKey key_of(const Json& line) {
  return {line.at("part"), line.at("scene"), line.at("settings"), line.at("seed")};
}

Json json_of(const TuneKey& key, const TradeRecord& record) {
  const auto& [part, scene, settings, seed] = key;
  Json json = {{"part", part}, {"scene", scene}, {"settings", settings}, {"seed", seed}};
  json.update(measured_json(record));
  return json;
}

}  // namespace

TuneJournal::TuneJournal(const std::filesystem::path& folder, const std::string& plan)
    : file_(folder, {kFile, kSchema, plan}, [this](const Json& line) {
        records_.emplace(key_of(line), measured_of(line));
      }) {}

const TradeRecord* TuneJournal::find(const TuneKey& key) const {
  const auto found = records_.find(key);
  return found == records_.end() ? nullptr : &found->second;
}

void TuneJournal::append(const TuneKey& key, const TradeRecord& record) {
  if (records_.emplace(key, record).second) file_.append(json_of(key, record));
}

}  // namespace wobblebench::bench
