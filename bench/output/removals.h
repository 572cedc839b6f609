// What a command that does not reach its end removes.
#pragma once

#include <csignal>
#include <deque>
#include <filesystem>

namespace wobblebench::bench {

/// Files and folders of one command that are not results yet. The destructor removes them, the last
/// noted first; so do SIGINT, SIGTERM and SIGHUP, which then end the program with 128 + the
/// signal's number. A folder is removed only if it is empty. Signals are handled on the thread that
/// made this, so that no file is being made or renamed at that moment. One at a time.
class Removals {
 public:
  Removals();
  ~Removals();
  Removals(const Removals&) = delete;
  Removals& operator=(const Removals&) = delete;

  /// Each throws std::runtime_error where too many are noted.
  void note_file(const std::filesystem::path& path) { note(path, false); }
  void note_folder(const std::filesystem::path& path) { note(path, true); }

 private:
  void note(const std::filesystem::path& path, bool folder);

  std::deque<std::filesystem::path> paths_;  ///< a deque: the signal handler has pointers into it
};

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

}  // namespace wobblebench::bench
