#include "bench/output_folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <system_error>

#include "bench/user_error.h"

namespace wobblebench::bench {

namespace {

// What a signal handler may touch: plain memory and unlink(2). Paths are published last, by count.
constexpr std::size_t kMaxStaged = 64;
constexpr std::size_t kMaxPath = 4096;
std::array<char[kMaxPath], kMaxStaged> staged_paths;
std::atomic<std::size_t> staged_count = 0;

void remove_staged() {
  for (std::size_t i = 0; i < staged_count.load(); ++i) ::unlink(staged_paths[i]);
}

void on_signal(int signal) {
  remove_staged();
  ::_exit(128 + signal);
}

void remember(const std::filesystem::path& path) {
  const std::size_t slot = staged_count.load();
  if (slot >= kMaxStaged || path.native().size() >= kMaxPath) {
    throw std::runtime_error(path.string() + ": too many files or too long a name");
  }
  std::strcpy(staged_paths[slot], path.c_str());
  staged_count.store(slot + 1);
}

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
  const int file = ::open(probe.c_str(), O_CREAT | O_EXCL | O_WRONLY, 0644);
  if (file < 0) refuse(directory, std::strerror(errno));
  ::close(file);
  ::unlink(probe.c_str());
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

OutputFolder::~OutputFolder() {
  remove_staged();
  staged_count.store(0);
}

std::filesystem::path OutputFolder::stage(const std::string& name) {
  // The process number keeps two runs into one folder apart.
  const auto partial = directory_ / (".partial-" + std::to_string(::getpid()) + "-" + name);
  remember(partial);
  files_.push_back({partial, directory_ / name});
  return partial;
}

void OutputFolder::write_text(const std::string& name, const std::string& text) {
  std::ofstream file(stage(name), std::ios::binary);
  file << text;
  file.close();
  if (!file)
    throw std::runtime_error((directory_ / name).string() +
                             ": cannot be written: " + std::strerror(errno));
}

void OutputFolder::commit() {
  for (const File& file : files_) std::filesystem::rename(file.partial, file.final);
  files_.clear();
  staged_count.store(0);
}

}  // namespace wobblebench::bench
