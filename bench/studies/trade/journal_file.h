// The file that keeps finished measurements as they come, so that no interruption loses them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>

#include "base/file.h"

namespace wobblebench::bench {

/// Name of a journal's file, and what its first line says.
struct JournalHead {
  std::string file;    ///< "points.jsonl"
  std::string schema;  ///< "wobblebench.trade.points/3"
  std::string plan;    ///< hash of all that its lines follow from
};

/// Called for the line of each measurement, in their order. A std::exception of nlohmann::json says
/// that the line is none.
using TakeLine = std::function<void(const nlohmann::ordered_json& line)>;

/// Lines of JSON, each with the CRC-32C of its text, so that a line that was changed is found and
/// never taken for another measurement. The head is first, then come measurements and the machines
/// that made them. A last line without its end, as a killed command leaves it, is taken off. A
/// journal without a measurement counts as none, whatever plan it is of.
class JournalFile {
 public:
  /// Reads the file in `folder`, if there is one, and changes nothing. Throws UserError
  /// "--out = DIR: reason" for a file that is damaged or of another plan, for what is no regular
  /// file, and for a link, be it a symbolic or a hard one: what is appended would get into a file
  /// that belongs to something else.
  JournalFile(const std::filesystem::path& folder, const JournalHead& head, const TakeLine& take);

  /// On the disk when it returns. The first one makes the file. Throws std::runtime_error.
  void append(const nlohmann::ordered_json& line);
  /// Notes by which machine the following lines are measured, unless the journal has it already.
  void append_machine(const std::string& machine);

  const std::set<std::string>& machines() const { return machines_; }
  /// Measurements that the file held when it was opened.
  std::size_t kept() const { return kept_; }
  /// Says so on stderr, in one line, where there were any.
  void say_kept() const;

 private:
  void begin();
  void write(const nlohmann::ordered_json& line);

  std::filesystem::path path_;
  JournalHead head_;
  FileDescriptor file_;    ///< not open: the file is not made yet
  std::size_t whole_ = 0;  ///< bytes up to the end of the last whole line that counts
  std::size_t kept_ = 0;   ///< measurements up to there
  bool begun_ = false;     ///< the file ends there
  std::set<std::string> machines_;
};

/// Reads the journal of another folder, which must have one. Returns its machines. Throws UserError
/// "OPTION = DIR: reason", as JournalFile does; links are followed.
std::set<std::string> read_journal(const std::filesystem::path& folder,
                                   const JournalHead& head,
                                   const std::string& option,
                                   const TakeLine& take);

}  // namespace wobblebench::bench
