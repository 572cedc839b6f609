#include "tests/support/process.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "base/file.h"
#include "tests/support/bytes_of.h"

namespace wobblebench::testing_support {

namespace {

namespace fs = std::filesystem;

/// Longer than any program under test takes, and shorter than CTest waits: one that hangs is ended
/// by SIGALRM, and not left behind.
constexpr unsigned kLongestRun_s = 600;

void redirect(const fs::path& path, int descriptor) {
  const FileDescriptor file(::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644));
  ::dup2(file.get(), descriptor);
}

/// What $XDG_CACHE_HOME is for the program; none: unset.
std::optional<fs::path> cache_home(const ProcessLimits& limits) {
  if (limits.no_cache) return std::nullopt;
  if (limits.cache_home) return limits.cache_home;
  static const ScratchFolder shared;
  return shared.path();
}

/// Shaders stay where Mesa keeps them without $XDG_CACHE_HOME: compiled once, not for each suite.
void keep_shaders_of_user() {
  const passwd* user = ::getpwuid(::getuid());
  if (!user) return;
  ::setenv("MESA_SHADER_CACHE_DIR", (fs::path(user->pw_dir) / ".cache").c_str(), 0);
}

[[noreturn]] void become(const fs::path& program,
                         const std::vector<std::string>& arguments,
                         const fs::path& directory,
                         const ProcessLimits& limits,
                         const std::optional<fs::path>& cache) {
  if (limits.file_bytes) {
    const auto bytes = static_cast<rlim_t>(*limits.file_bytes);
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  // Unset, not empty: Mesa complains of an empty one on stderr.
  for (const char* name : {"XDG_CACHE_HOME", "HOME"}) ::unsetenv(name);
  if (cache) ::setenv("XDG_CACHE_HOME", cache->c_str(), 1);
  if (cache && !limits.cache_home) keep_shaders_of_user();
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  for (const auto& [name, value] : limits.environment) ::setenv(name.c_str(), value.c_str(), 1);
  for (const int stream : limits.closed) ::close(stream);
  ::alarm(kLongestRun_s);
  if (::chdir(directory.c_str()) == 0) ::execv(program.c_str(), argv.data());
  ::_exit(127);
}

/// Sends the signal that `limits` ask for, and waits for the child's end.
int wait_for(pid_t child, const ProcessLimits& limits) {
  int status = 0;
  while (limits.interrupt_when) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    if (limits.interrupt_when()) {
      ::kill(child, limits.signal);
      break;
    }
    // The program needs the cores.
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (limits.interrupt_after) {
    std::this_thread::sleep_for(*limits.interrupt_after);
    ::kill(child, limits.signal);
  }
  ::waitpid(child, &status, 0);
  return status;
}

int exit_code_of(int status) {
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

ProcessResult run_process(const fs::path& program,
                          const std::vector<std::string>& arguments,
                          const fs::path& directory,
                          const ProcessLimits& limits) {
  const ScratchFolder output;
  const auto cache = cache_home(limits);
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    redirect(output.path() / "out", STDOUT_FILENO);
    redirect(output.path() / "err", STDERR_FILENO);
    become(program, arguments, directory, limits, cache);
  }
  const int status = wait_for(child, limits);
  return {exit_code_of(status), bytes_of(output.path() / "out"), bytes_of(output.path() / "err")};
}

ScratchFolder::ScratchFolder() : maker_(::getpid()) {
  std::string pattern = (fs::temp_directory_path() / "wobblebench-XXXXXX").string();
  if (!::mkdtemp(pattern.data())) throw std::runtime_error(pattern + ": cannot be made");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  if (::getpid() != maker_) return;
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::vector<std::string> ScratchFolder::files(const std::string& folder) const {
  std::vector<std::string> names;
  if (!fs::exists(path_ / folder)) return names;
  for (const auto& entry : fs::directory_iterator(path_ / folder))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

fs::path ScratchFolder::write(const std::string& name, const std::string& text) const {
  const auto path = path_ / name;
  std::ofstream(path) << text;
  return path;
}

}  // namespace wobblebench::testing_support
