#include "bench/report/output_folder.h"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "base/file_descriptor.h"
#include "base/write_file.h"
#include "bench/cli/user_error.h"

namespace wobblebench::bench {

namespace {

// What a signal handler may touch: plain memory and unlink(2). Paths are published last, by count.
constexpr std::size_t kMaxStaged = 64;
constexpr std::size_t kMaxPath = 4096;
std::array<char[kMaxPath], kMaxStaged> staged_paths;
std::atomic<std::size_t> staged_count = 0;
pthread_t writing_thread;

void remove_staged() {
  for (std::size_t i = 0; i < staged_count.load(); ++i) ::unlink(staged_paths[i]);
}

/// Any thread may be given the signal. Handled on the one that writes, it cannot meet a file that
/// is just being made, nor one that is being renamed while that thread holds signals off.
void on_signal(int signal) {
  if (!::pthread_equal(::pthread_self(), writing_thread)) {
    ::pthread_kill(writing_thread, signal);
    return;
  }
  remove_staged();
  ::_exit(128 + signal);
}

void remember(const std::filesystem::path& path) {
  const std::size_t slot = staged_count.load();
  if (slot >= kMaxStaged || path.native().size() >= kMaxPath) {
    throw std::runtime_error(path.string() + ": too many files or too long a name");
  }
  path.native().copy(staged_paths[slot], kMaxPath - 1);
  staged_paths[slot][path.native().size()] = '\0';
  staged_count.store(slot + 1);
}

/// Holds SIGINT and SIGTERM off this thread while it lives.
class SignalsHeld {
 public:
  SignalsHeld() {
    sigset_t signals;
    ::sigemptyset(&signals);
    ::sigaddset(&signals, SIGINT);
    ::sigaddset(&signals, SIGTERM);
    ::pthread_sigmask(SIG_BLOCK, &signals, &before_);
  }
  ~SignalsHeld() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeld(const SignalsHeld&) = delete;
  SignalsHeld& operator=(const SignalsHeld&) = delete;

 private:
  sigset_t before_;
};

void refuse(const std::filesystem::path& directory, const std::string& reason) {
  throw UserError("--out = " + directory.string() + ": " + reason +
                  "; must be a folder that can be written");
}

}  // namespace

OutputFolder::OutputFolder(const std::filesystem::path& directory) : directory_(directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) refuse(directory, error.message());
  const auto probe = directory / (".partial-" + std::to_string(::getpid()));
  FileDescriptor file(::open(probe.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0644));
  if (!file.is_open()) refuse(directory, std::strerror(errno));
  file.close();
  ::unlink(probe.c_str());
  writing_thread = ::pthread_self();
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

OutputFolder::~OutputFolder() {
  remove_staged();
  staged_count.store(0);
}

std::filesystem::path OutputFolder::stage(const std::string& name) {
  // The process number keeps two runs into one folder apart.
  auto partial = directory_ / (".partial-" + std::to_string(::getpid()) + "-" + name);
  remember(partial);
  files_.push_back({partial, directory_ / name});
  return partial;
}

void OutputFolder::write_text(const std::string& name, std::string_view text) {
  write_file(stage(name), text);
}

void OutputFolder::commit() {
  for (const File& file : files_) {
    // The likely failure, found before the first file has its name.
    std::error_code ignored;
    if (std::filesystem::is_directory(file.final, ignored)) {
      throw std::runtime_error(file.final.string() + ": is a folder; cannot be replaced by a file");
    }
  }
  const SignalsHeld held;
  for (const File& file : files_) {
    std::error_code error;
    std::filesystem::rename(file.partial, file.final, error);
    if (error) throw std::runtime_error(file.final.string() + ": " + error.message());
  }
  files_.clear();
  staged_count.store(0);
}

}  // namespace wobblebench::bench
