// Results on disk: whole files under their final names, or none.
#pragma once

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/file.h"

namespace wobblebench::bench {

/// Files and folders of one command that are not results yet. The destructor removes them, the last
/// noted first; so do SIGINT, SIGTERM and SIGHUP, which then say "interrupted" on stderr and end
/// the program with 128 + the signal's number. A folder is removed only if it is empty. Signals are
/// handled on the thread that made this, so that no file is being made or renamed at that moment.
/// One at a time.
class Removals {
 public:
  Removals();
  ~Removals();
  Removals(const Removals&) = delete;
  Removals& operator=(const Removals&) = delete;

  /// `folder`: an open descriptor that outlives this, from which the path is taken. Each throws
  /// std::runtime_error where too many are noted.
  void note_file(int folder, const std::filesystem::path& path) { note(folder, path, false); }
  void note_folder(int folder, const std::filesystem::path& path) { note(folder, path, true); }
  std::size_t size() const { return paths_.size(); }
  /// All but the first `most` are results now, and stay.
  void forget_after(std::size_t most);

 private:
  void note(int from, const std::filesystem::path& path, bool folder);

  std::deque<std::filesystem::path> paths_;  ///< a deque: the signal handler has pointers into it
};

/// The system's reason, or that the path leads through a link to nothing, which the system calls
/// "File exists".
std::string why_not_made(const std::filesystem::path& folder, const std::error_code& error);

/// Blocks these signals on this thread while it lives.
class BlockedSignals {
 public:
  BlockedSignals();
  ~BlockedSignals();
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
};

/// The files of one command: collected in a hidden folder, and given their final names together by
/// commit(). No other command can use the folder meanwhile.
///
/// commit() syncs the files, renames `.wobblebench-partial` to `.wobblebench-commit`, and moves its
/// files. A command that is killed before that one rename leaves the old results, and one that is
/// killed after it the new ones: the next command with this folder moves what is left to move.
///
/// Both folders are reached by descriptors, and new files are no links: a folder or a link that
/// something else puts in their place while the command works is refused, and no file in or behind
/// it is moved, changed or removed.
///
/// Without commit() everything is removed as Removals has it, with the folders that the constructor
/// made. All functions are called on one thread.
class OutputFolder {
 public:
  /// Makes the folder if it is missing, locks it, and completes or removes what a killed command
  /// left in it. Throws UserError "--out = DIR: reason", with the option that named the folder, and
  /// as check_space() where the disk has no room for a report.
  explicit OutputFolder(const std::filesystem::path& directory, std::string option = "--out");
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Throws UserError if `input`, a file that this command reads, would be replaced by its result
  /// `name`.
  void refuse_input(const std::filesystem::path& input, const std::string& name) const;

  /// Throws std::runtime_error "DIR: …" where its disk has less room than this for a new file.
  void check_space(std::uint64_t bytes) const;

  /// The path to write the new file `name` to. Its extension is that of `name`.
  [[nodiscard]] std::filesystem::path stage(const std::string& name);
  /// Stages a text, or any bytes. Throws std::runtime_error when they cannot be written whole.
  void write_text(const std::string& name, std::string_view text);
  /// The bytes of a file that was staged and written. Throws std::runtime_error.
  std::string read_staged(const std::string& name) const;
  /// Stages a file that is already in this folder and must survive a kill at any time: it keeps its
  /// own name until it has the final one. Throws std::runtime_error.
  void adopt(const std::filesystem::path& file, const std::string& name);
  /// Throws std::runtime_error "PATH: reason", with nothing renamed if PATH is a folder, or if
  /// anything is in `.wobblebench-partial` that this command did not make.
  void commit();

  const std::filesystem::path& directory() const { return directory_; }
  /// What a user should know of the folder: that nothing keeps another command out; empty: nothing.
  std::string warning() const;

 private:
  [[noreturn]] void refuse(const std::string& reason, const std::string& allowed) const;
  void make_directory();
  void open_directory();
  void complete_killed_command();
  void make_partial();
  void check_partial() const;
  void check_staged() const;
  void move_committed(const FileDescriptor& committed, const std::vector<std::string>& names) const;

  std::filesystem::path directory_;
  std::string option_;
  FileDescriptor folder_;   ///< directory_
  FileDescriptor partial_;  ///< the files that are staged
  std::optional<FolderLock> lock_;
  Removals removals_;                           ///< after the lock: removes while it is held
  std::size_t before_partial_ = 0;              ///< noted before `.wobblebench-partial`
  std::vector<std::string> names_;              ///< staged
  std::vector<std::filesystem::path> adopted_;  ///< by their own names
};

}  // namespace wobblebench::bench
