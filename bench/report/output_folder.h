// Results on disk: whole files under their final names, or none.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <string_view>

namespace wobblebench::bench {

/// Collects the files of one command under hidden partial names and gives them their final names
/// together in commit(). The destructor removes them if commit() was not reached; so do Ctrl-C and
/// SIGTERM, which then end the program with 128 + the signal's number. Both signals are handled on
/// the thread that made the folder, which must be the one that stages and commits. One at a time.
class OutputFolder {
 public:
  /// Makes the folder if it is missing and checks that it can be written.
  /// Throws UserError "--out = DIR: reason".
  explicit OutputFolder(const std::filesystem::path& directory);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// The partial path to write the file `name` to. Its extension is that of `name`.
  [[nodiscard]] std::filesystem::path stage(const std::string& name);
  /// Stages a text, or any bytes. Throws std::runtime_error when they cannot be written whole.
  void write_text(const std::string& name, std::string_view text);
  /// Gives every staged file its final name; signals are blocked meanwhile.
  /// Throws std::runtime_error "PATH: reason", with nothing renamed if PATH is a folder.
  void commit();

  const std::filesystem::path& directory() const { return directory_; }

 private:
  struct File {
    std::filesystem::path partial;
    std::filesystem::path final;
  };
  std::filesystem::path directory_;
  std::deque<File> files_;  ///< a deque: the signal handler holds pointers into it
};

}  // namespace wobblebench::bench
