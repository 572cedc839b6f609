// What `trade` measures of one point on one scene and seed, and its journal.
#pragma once

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/evaluation/measures/picture_measures.h"
#include "bench/results/times.h"
#include "bench/studies/evaluator/evaluator.h"
#include "bench/studies/trade/journal_file.h"

namespace wobblebench::bench {

/// Which measurement of a plan: the smallest piece of its work.
struct TradeUnit {
  std::size_t scene = 0;  ///< numbers of the plan
  std::size_t point = 0;
  std::size_t seed = 0;

  // clang-tidy 14 takes the comparison with 0 within it for that of a pointer.
  auto operator<=>(const TradeUnit&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// A record's measures.
Chosen traded();
/// A value for each; NaN: not formed, as without a surface in view.
std::vector<double> trade_measures(const PictureMeasures& measures);
/// Position of a key. Throws std::out_of_range.
std::size_t trade_measure(const std::string& key);

/// Times of a picture, and their ratios to those of the reference's picture. `volume`: all passes;
/// `view`: passes 2 to 4.
struct TradeTimes {
  double volume_ms = 0, view_ms = 0, volume_ratio = 0, view_ratio = 0;
};
inline constexpr std::pair<const Measure*, double TradeTimes::*> kTradeTimes[] = {
    {&times::kVolume, &TradeTimes::volume_ms},
    {&times::kView, &TradeTimes::view_ms},
    {&times::kVolumeRatio, &TradeTimes::volume_ratio},
    {&times::kViewRatio, &TradeTimes::view_ratio}};

/// The times are medians over the repeats; the two pictures are rendered in turn.
struct TradeRecord : TradeTimes {
  TradeUnit unit;
  std::string refused;  ///< the line that refused the point; empty: it was measured
  std::vector<double> measures;
  /// Wall times of the evaluation that the measures are from: making the renderer with its first
  /// picture's shaders and sticks, the picture, the truth where it is a new view, the measures.
  EvaluationTimes evaluation;
};

using TradeRecords = std::map<TradeUnit, TradeRecord>;

struct TradeContent {
  TradeRecords records;
  std::set<std::string> machines;  ///< that measured them: program, CPU and renderer
};

/// What was measured, without the unit, as a line of a journal has it, and back. The latter throws
/// an exception of nlohmann::json for any other object.
nlohmann::ordered_json measured_json(const TradeRecord& record);
TradeRecord measured_of(const nlohmann::ordered_json& json);

/// The journal of `trade`: a line for each record, in the order of the work.
class TradeJournal {
 public:
  static constexpr const char* kFile = "points.jsonl";

  /// As JournalFile. `plan`: hash of all that the records follow from.
  TradeJournal(const std::filesystem::path& folder, const std::string& plan);
  TradeJournal(const TradeJournal&) = delete;
  TradeJournal& operator=(const TradeJournal&) = delete;

  const TradeRecords& records() const { return records_; }
  const JournalFile& file() const { return file_; }
  /// As JournalFile. A unit that is there already stays as it is.
  void append(const TradeRecord& record);
  void append_machine(const std::string& machine) { file_.append_machine(machine); }

 private:
  TradeRecords records_;
  JournalFile file_;  ///< after the records: it reads them
};

/// Records as a text, and back: lines as the journal has them, without its head. Throws
/// std::runtime_error for any other text.
std::string text_of(const TradeRecords& records);
TradeRecords trade_records(const std::string& text);

/// The content of another folder's journal, as read_journal().
TradeContent read_trade_journal(const std::filesystem::path& folder,
                                const std::string& plan,
                                const std::string& option);

}  // namespace wobblebench::bench
