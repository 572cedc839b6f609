#include "bench/output/output_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

constexpr const char* kPartial = ".wobblebench-partial";
constexpr const char* kCommit = ".wobblebench-commit";
constexpr const char* kWritable = "can be written";

constexpr std::uint64_t kReportBytes = 65536;  // what every command writes at least, and more

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw std::runtime_error(path.string() + ": cannot be written: " + reason);
}

/// A folder of that name within another; not open, with errno: there is none, or it is a link.
FileDescriptor open_folder(int within, const char* name) {
  return FileDescriptor(
      ::openat(within, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
}

/// The names in an open folder.
std::vector<std::string> names_in(const FileDescriptor& folder, const fs::path& path) {
  // fdopendir(3) takes its descriptor, and reads on from where another one of the same open folder
  // is.
  const int again = ::openat(folder.get(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  DIR* const stream = again < 0 ? nullptr : ::fdopendir(again);
  if (stream == nullptr) fail(path, std::strerror(errno));
  std::vector<std::string> names;
  while (const dirent* const entry = ::readdir(stream)) names.emplace_back(entry->d_name);
  ::closedir(stream);
  std::erase_if(names, [](const std::string& name) { return name == "." || name == ".."; });
  return names;
}

bool is_same(const struct stat& one, const struct stat& other) {
  return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

bool is_file_in(const FileDescriptor& folder, const std::string& name) {
  struct stat status {};
  return ::fstatat(folder.get(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) == 0 &&
         S_ISREG(status.st_mode);
}

void sync_file_in(const FileDescriptor& folder, const std::string& name, const fs::path& path) {
  const FileDescriptor file(
      ::openat(folder.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
  const int error = file.is_open() ? sync_file(file.get()) : errno;
  if (error != 0) fail(path, std::strerror(error));
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
  int from;
  const char* path;
  bool folder;
};

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

// State of the signal handler, which has no other way to get it: it may only read plain memory and
// call unlinkat(2) and write(2). `count` publishes the entries.
constexpr std::size_t kMost = 256;
std::array<Noted, kMost> noted;
std::atomic<std::size_t> count = 0;
pthread_t owner;
std::string_view last_words;

void remove_noted() {
  for (std::size_t i = count.load(); i-- > 0;) {
    ::unlinkat(noted[i].from, noted[i].path, noted[i].folder ? AT_REMOVEDIR : 0);
  }
}

/// A signal may be delivered to any thread.
void on_signal(int signal) {
  if (!::pthread_equal(::pthread_self(), owner)) {
    ::pthread_kill(owner, signal);
    return;
  }
  remove_noted();
  static_cast<void>(!::write(STDERR_FILENO, last_words.data(), last_words.size()));
  ::_exit(128 + signal);
}

}  // namespace

std::string why_not_made(const fs::path& folder, const std::error_code& error) {
  std::error_code ignored;
  for (const fs::path& missing : missing_folders(folder)) {
    if (!fs::is_symlink(missing, ignored)) continue;
    return missing.string() + " is a symbolic link to " +
           fs::read_symlink(missing, ignored).string() + ", which leads to no folder";
  }
  return error.message();
}

OutputFolder::OutputFolder(const fs::path& directory, std::string option)
    : directory_(directory), option_(std::move(option)) {
  const BlockedSignals blocked;  // nothing exists that is not noted
  make_directory();
  try {
    open_directory();
    lock_.emplace(directory_);
    removals_.note_file(AT_FDCWD, lock_->file());
    complete_killed_command();
  } catch (const FolderInUse& in_use) {
    refuse(in_use.what(), "no other command writes to");
  } catch (const std::system_error& error) {
    refuse(error.code().message(), kWritable);
  }
  check_space(kReportBytes);
  make_partial();
}

void OutputFolder::refuse(const std::string& reason, const std::string& allowed) const {
  throw UserError(option_ + " = " + directory_.string() + ": " + reason +
                  "; must be a folder that " + allowed);
}

std::string OutputFolder::warning() const {
  if (lock_->keeps_others_out()) return "";
  return option_ + " = " + directory_.string() +
         ": its file system has no locks (flock); another command that writes to it meanwhile is "
         "not kept out";
}

void OutputFolder::make_directory() {
  for (const fs::path& folder : missing_folders(directory_)) {
    std::error_code error;
    if (fs::create_directory(folder, error)) removals_.note_folder(AT_FDCWD, folder);
    if (error) refuse(why_not_made(folder, error), kWritable);
  }
  std::error_code error;
  if (fs::is_directory(directory_, error)) return;
  refuse(error ? error.message() : "is no folder", kWritable);
}

void OutputFolder::open_directory() {
  folder_ = FileDescriptor(::open(directory_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder_.is_open()) throw std::system_error(errno, std::generic_category());
}

void OutputFolder::complete_killed_command() {
  const FileDescriptor committed = open_folder(folder_.get(), kCommit);
  if (committed.is_open()) {
    move_committed(committed, names_in(committed, directory_ / kCommit));
  } else if (errno != ENOENT) {
    refuse(std::string("its ") + kCommit + " is no folder", kWritable);
  }
  fs::remove_all(directory_ / kPartial);
}

void OutputFolder::make_partial() {
  if (::mkdirat(folder_.get(), kPartial, 0700) != 0) refuse(std::strerror(errno), kWritable);
  before_partial_ = removals_.size();
  removals_.note_folder(folder_.get(), kPartial);
  partial_ = open_folder(folder_.get(), kPartial);
  if (!partial_.is_open()) fail(directory_ / kPartial, std::strerror(errno));
}

void OutputFolder::check_space(std::uint64_t bytes) const {
  struct statvfs disk {};
  // A file system without blocks does not say how large it is.
  if (::fstatvfs(folder_.get(), &disk) != 0 || disk.f_blocks == 0) return;
  const std::uint64_t blocks = ::geteuid() == 0 ? disk.f_bfree : disk.f_bavail;
  const std::uint64_t left = blocks * disk.f_frsize;
  if (left >= bytes) return;
  const auto megabytes = [](std::uint64_t size) {
    return fixed(1e-6 * static_cast<double>(size), 2) + " MB";
  };
  throw std::runtime_error(directory_.string() + ": its disk has " + megabytes(left) +
                           " left; this command needs about " + megabytes(bytes));
}

/// Whether the folder that has the name is the one that was made.
void OutputFolder::check_partial() const {
  struct stat made {
  }, named{};
  const bool is_there = ::fstat(partial_.get(), &made) == 0 &&
                        ::fstatat(folder_.get(), kPartial, &named, AT_SYMLINK_NOFOLLOW) == 0;
  if (is_there && is_same(made, named)) return;
  fail(directory_ / kPartial, "something else has put another in its place");
}

void OutputFolder::refuse_input(const fs::path& input, const std::string& name) const {
  std::error_code ignored;
  if (!fs::equivalent(input, directory_ / name, ignored)) return;
  refuse("its " + name + " is read by this command", "holds none of its inputs");
}

fs::path OutputFolder::stage(const std::string& name) {
  check_partial();
  struct stat there {};
  if (::fstatat(partial_.get(), name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 &&
      std::ranges::find(names_, name) == names_.end()) {
    fail(directory_ / kPartial / name, "something else has made it");
  }
  names_.push_back(name);
  removals_.note_file(partial_.get(), name);
  return directory_ / kPartial / name;
}

void OutputFolder::write_text(const std::string& name, std::string_view text) {
  write_new_file(stage(name), text, partial_.get());
}

std::string OutputFolder::read_staged(const std::string& name) const {
  const FileDescriptor file(
      ::openat(partial_.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  if (file.get() < 0) fail(directory_ / kPartial / name, std::strerror(errno));
  return read_file(file, directory_ / kPartial / name);
}

void OutputFolder::adopt(const fs::path& file, const std::string& name) {
  static_cast<void>(stage(name));
  if (::linkat(AT_FDCWD, file.c_str(), partial_.get(), name.c_str(), 0) == 0) {
    adopted_.push_back(file);
    return;
  }
  const bool has_no_links = errno == EPERM || errno == ENOTSUP || errno == ENOSYS;
  if (!has_no_links) fail(directory_ / name, std::strerror(errno));
  // FAT, say: the file gets its name at once, before the others.
  names_.pop_back();
  if (::renameat(AT_FDCWD, file.c_str(), folder_.get(), name.c_str()) == 0) return;
  fail(directory_ / name, std::strerror(errno));
}

/// The files of this command and nothing else, each of which can have its name.
void OutputFolder::check_staged() const {
  for (const std::string& name : names_in(partial_, directory_ / kPartial)) {
    const bool is_mine = std::ranges::find(names_, name) != names_.end();
    if (!is_mine || !is_file_in(partial_, name)) {
      fail(directory_ / kPartial / name, "something else has made it");
    }
  }
  for (const std::string& name : names_) {
    // The likely failure, found before the first file has its name.
    std::error_code ignored;
    if (!fs::is_directory(directory_ / name, ignored)) continue;
    throw std::runtime_error((directory_ / name).string() +
                             ": is a folder; cannot be replaced by a file");
  }
}

void OutputFolder::commit() {
  if (names_.empty()) return;
  check_staged();
  for (const std::string& name : names_) sync_file_in(partial_, name, directory_ / kPartial / name);
  sync_folder(directory_ / kPartial);
  const BlockedSignals blocked;
  check_partial();
  if (::renameat(folder_.get(), kPartial, folder_.get(), kCommit) != 0) {
    fail(directory_ / kCommit, std::strerror(errno));
  }
  removals_.forget_after(before_partial_);
  sync_folder(directory_);
  move_committed(partial_, names_);
  for (const fs::path& file : adopted_) fs::remove(file);
  names_.clear();
  adopted_.clear();
}

void OutputFolder::move_committed(const FileDescriptor& committed,
                                  const std::vector<std::string>& names) const {
  const auto fail_to_move = [&](const fs::path& to, const std::string& reason) {
    fail(to,
         reason + "; the results are in " + (directory_ / kCommit).string() +
             ", and the next command with this folder gives them their names");
  };
  for (const std::string& name : names) {
    if (!is_file_in(committed, name)) fail_to_move(directory_ / kCommit / name, "is no file");
    if (::renameat(committed.get(), name.c_str(), folder_.get(), name.c_str()) != 0) {
      fail_to_move(directory_ / name, std::strerror(errno));
    }
    // rename(2) does nothing where both are names of one file.
    ::unlinkat(committed.get(), name.c_str(), 0);
  }
  sync_folder(directory_);
  if (::unlinkat(folder_.get(), kCommit, AT_REMOVEDIR) != 0) {
    fail(directory_ / kCommit, std::strerror(errno));
  }
}

Removals::Removals() {
  owner = ::pthread_self();
  // On a terminal the line of progress is overwritten.
  last_words = ::isatty(STDERR_FILENO) != 0 ? "\r\x1b[Kwobblebench: interrupted\n"
                                            : "wobblebench: interrupted\n";
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

void Removals::note(int from, const std::filesystem::path& path, bool folder) {
  const std::size_t index = count.load();
  if (index == kMost) throw std::runtime_error(path.string() + ": too many files");
  paths_.push_back(path);
  noted[index] = {from, paths_.back().c_str(), folder};
  count.store(index + 1);
}

void Removals::forget_after(std::size_t most) {
  count.store(most);
  paths_.resize(most);
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
