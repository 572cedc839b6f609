#include "bench/output/output_folder.h"

#include <pthread.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

constexpr const char* kPartial = ".wobblebench-partial";
constexpr const char* kCommit = ".wobblebench-commit";
constexpr const char* kWritable = "can be written";

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw std::runtime_error(path.string() + ": cannot be written: " + reason);
}

void rename_file(const fs::path& from, const fs::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) fail(to, std::strerror(errno));
  // rename(2) does nothing where both are names of one file.
  ::unlink(from.c_str());
}

/// The folders of `path` that are missing, outermost first.
std::vector<fs::path> missing_folders(const fs::path& path) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (fs::path folder = path; !folder.empty() && !fs::exists(folder, ignored);
       folder = folder.parent_path()) {
    missing.insert(missing.begin(), folder);
  }
  return missing;
}

struct Noted {
  const char* path;
  bool folder;
};

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

// State of the signal handler, which has no other way to get it: it may only read plain memory and
// call unlink(2) and rmdir(2). `count` publishes the entries.
constexpr std::size_t kMost = 256;
std::array<Noted, kMost> noted;
std::atomic<std::size_t> count = 0;
pthread_t owner;

void remove_noted() {
  for (std::size_t i = count.load(); i-- > 0;) {
    noted[i].folder ? ::rmdir(noted[i].path) : ::unlink(noted[i].path);
  }
}

/// A signal may be delivered to any thread.
void on_signal(int signal) {
  if (!::pthread_equal(::pthread_self(), owner)) {
    ::pthread_kill(owner, signal);
    return;
  }
  remove_noted();
  ::_exit(128 + signal);
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& directory, std::string option)
    : directory_(directory), option_(std::move(option)) {
  const BlockedSignals blocked;  // nothing exists that is not noted
  make_directory();
  try {
    lock_.emplace(directory_);
    removals_.note_file(lock_->file());
    complete_killed_command();
  } catch (const FolderInUse& in_use) {
    refuse(in_use.what(), "no other command writes to");
  } catch (const std::system_error& error) {
    refuse(error.code().message(), kWritable);
  }
}

void OutputFolder::refuse(const std::string& reason, const std::string& allowed) const {
  throw UserError(option_ + " = " + directory_.string() + ": " + reason +
                  "; must be a folder that " + allowed);
}

void OutputFolder::make_directory() {
  for (const fs::path& folder : missing_folders(directory_)) {
    std::error_code error;
    if (fs::create_directory(folder, error)) removals_.note_folder(folder);
    if (error) refuse(error.message(), kWritable);
  }
  std::error_code error;
  if (fs::is_directory(directory_, error)) return;
  refuse(error ? error.message() : "is no folder", kWritable);
}

void OutputFolder::complete_killed_command() {
  if (fs::is_directory(fs::symlink_status(directory_ / kCommit))) move_committed();
  fs::remove_all(directory_ / kPartial);
}

void OutputFolder::refuse_input(const fs::path& input, const std::string& name) const {
  std::error_code ignored;
  if (!fs::equivalent(input, directory_ / name, ignored)) return;
  refuse("its " + name + " is read by this command", "holds none of its inputs");
}

fs::path OutputFolder::stage(const std::string& name) {
  const fs::path folder = directory_ / kPartial;
  if (names_.empty()) {
    const BlockedSignals blocked;  // nothing exists that is not noted
    std::error_code error;
    fs::create_directory(folder, error);
    if (error) fail(folder, error.message());
    removals_.note_folder(folder);
  }
  names_.push_back(name);
  removals_.note_file(folder / name);
  return folder / name;
}

void OutputFolder::write_text(const std::string& name, std::string_view text) {
  write_file(stage(name), text);
}

void OutputFolder::adopt(const fs::path& file, const std::string& name) {
  const fs::path staged = stage(name);
  if (::link(file.c_str(), staged.c_str()) == 0) {
    adopted_.push_back(file);
    return;
  }
  const bool has_no_links = errno == EPERM || errno == ENOTSUP || errno == ENOSYS;
  if (!has_no_links) fail(directory_ / name, std::strerror(errno));
  // FAT, say: the file gets its name at once, before the others.
  names_.pop_back();
  rename_file(file, directory_ / name);
}

void OutputFolder::commit() {
  if (names_.empty()) return;
  for (const std::string& name : names_) {
    // The likely failure, found before the first file has its name.
    std::error_code ignored;
    if (fs::is_directory(directory_ / name, ignored)) {
      throw std::runtime_error((directory_ / name).string() +
                               ": is a folder; cannot be replaced by a file");
    }
    sync_file(directory_ / kPartial / name);
  }
  sync_folder(directory_ / kPartial);
  const BlockedSignals blocked;
  rename_file(directory_ / kPartial, directory_ / kCommit);
  sync_folder(directory_);
  move_committed();
  for (const fs::path& file : adopted_) fs::remove(file);
  names_.clear();
  adopted_.clear();
}

void OutputFolder::move_committed() const {
  const fs::path committed = directory_ / kCommit;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(committed)) files.push_back(entry.path());
  for (const fs::path& file : files) rename_file(file, directory_ / file.filename());
  sync_folder(directory_);
  fs::remove(committed);
}

Removals::Removals() {
  owner = ::pthread_self();
  for (const int signal : kSignals) {
    const auto before = std::signal(signal, on_signal);
    // Under nohup(1) the program is to live on.
    if (signal == SIGHUP && before == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

Removals::~Removals() {
  remove_noted();
  count.store(0);
}

void Removals::note(const std::filesystem::path& path, bool folder) {
  const std::size_t index = count.load();
  if (index == kMost) throw std::runtime_error(path.string() + ": too many files");
  paths_.push_back(path);
  noted[index] = {paths_.back().c_str(), folder};
  count.store(index + 1);
}

BlockedSignals::BlockedSignals() {
  sigset_t signals;
  ::sigemptyset(&signals);
  for (const int signal : kSignals) ::sigaddset(&signals, signal);
  ::pthread_sigmask(SIG_BLOCK, &signals, &before_);
}

BlockedSignals::~BlockedSignals() {
  ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

}  // namespace wobblebench::bench
