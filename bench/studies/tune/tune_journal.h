// The journal of the command `tune`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "bench/studies/trade/journal_file.h"
#include "bench/studies/trade/trade_journal.h"

namespace wobblebench::bench {

/// Which measurement, whatever the order in which the search comes to it: the part of the command,
/// the scene's name in the plan, the values of the axes and the seed.
using TuneKey = std::tuple<std::string, std::string, std::vector<std::string>, std::uint64_t>;

/// Measurements that an interrupted `tune` has made; with them the same search goes the same way
/// again, and measures from there on. See JournalFile.
class TuneJournal {
 public:
  static constexpr const char* kFile = "tune_points.jsonl";  ///< beside that of a trade

  /// `plan`: hash of the plan's scenes and settings. What is asked for is no part of it: with
  /// another limit the measurements are the same.
  TuneJournal(const std::filesystem::path& folder, const std::string& plan);
  TuneJournal(const TuneJournal&) = delete;
  TuneJournal& operator=(const TuneJournal&) = delete;

  const JournalFile& file() const { return file_; }
  void append_machine(const std::string& machine) { file_.append_machine(machine); }

  /// Null: it was not measured yet.
  const TradeRecord* find(const TuneKey& key) const;
  /// On the disk when it returns. Throws std::runtime_error.
  void append(const TuneKey& key, const TradeRecord& record);

 private:
  std::map<TuneKey, TradeRecord> records_;
  JournalFile file_;  ///< after the records: it reads them
};

/// A journal, and under which name a search stands in it; null: nothing is kept.
struct KeptSearch {
  TuneJournal* journal = nullptr;
  std::string part;
};

}  // namespace wobblebench::bench
