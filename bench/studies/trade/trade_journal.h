// The finished measurements of a plan, kept as they come, so that no interruption loses them.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "base/file.h"
#include "bench/studies/trade/trade_record.h"

namespace wobblebench::bench {

using TradeRecords = std::map<TradeUnit, TradeRecord>;

struct TradeContent {
  TradeRecords records;
  std::set<std::string> machines;  ///< that measured them: program, CPU and renderer
};

/// A file of lines of JSON: the plan first, then a line for each record, in the order of the work,
/// and for each machine. A last line without its end, of a command that was killed while it wrote,
/// is taken off.
class TradeJournal {
 public:
  static constexpr const char* kFile = "points.jsonl";

  /// Opens `folder`/points.jsonl, or makes it. `plan`: hash of all that its records follow from.
  /// Throws UserError where the file is of another plan, and std::runtime_error.
  TradeJournal(const std::filesystem::path& folder, const std::string& plan);

  const TradeRecords& records() const { return content_.records; }
  const std::set<std::string>& machines() const { return content_.machines; }
  /// On the disk when it returns. A unit that is there already stays as it is. Throws
  /// std::runtime_error.
  void append(const TradeRecord& record);
  /// Notes by which machine the following records are measured.
  void append_machine(const std::string& machine);

 private:
  std::filesystem::path path_;
  FileDescriptor file_;
  TradeContent content_;
};

/// Records as a text, and back: lines as the journal has them, without its head. Throws
/// std::runtime_error for a text that is none.
std::string text_of(const TradeRecords& records);
TradeRecords trade_records(const std::string& text);

/// The content of another folder. Throws UserError "OPTION = DIR: reason" where they are of another
/// plan or cannot be read.
TradeContent read_trade_journal(const std::filesystem::path& folder,
                                const std::string& plan,
                                const std::string& option);

}  // namespace wobblebench::bench
