// The include graph of our sources: what each file includes, directly and through other files.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace wobblebench {

/// Paths are relative to the project, as includes write them: "hw/board/board.h".
class IncludeGraph {
 public:
  /// Reads every .h and .cpp below `rooms` of `project`.
  IncludeGraph(const std::filesystem::path& project, const std::vector<std::string>& rooms);

  /// Every file that was read.
  std::vector<std::string> files() const;
  std::vector<std::string> files_below(const std::string& folder) const;
  /// What follows `#include` in a file, ours and others'.
  const std::vector<std::string>& direct(const std::string& file) const;
  /// Our files that a file includes, itself left out, each with the file through which it comes.
  std::map<std::string, std::string> reachable(const std::string& file) const;
  /// "a.h <- b.h <- c.cpp": how `file` comes to include `target`.
  std::string path_to(const std::string& file, const std::string& target) const;

 private:
  std::map<std::string, std::vector<std::string>> includes_;
};

/// The first part of a path: "hw" of "hw/board/board.h".
std::string room_of(const std::string& path);
/// All but the last part: "hw/board".
std::string folder_of(const std::string& path);

}  // namespace wobblebench
