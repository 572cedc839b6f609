#include "bench/command/machine_limits.h"

#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "base/file.h"
#include "bench/command/program.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

/// What the handler writes: it may allocate nothing.
std::string last_line;

void on_crash(int) {
  [[maybe_unused]] const ssize_t written =
      ::write(STDERR_FILENO, last_line.data(), last_line.size());
  ::_exit(kFailed);
}

void explain_crashes([[maybe_unused]] const char* program) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const std::string limit = address_space_limit();
  if (limit.empty()) return;
  last_line = std::string(program) + ": out of memory" + limit +
              ", for want of which the program crashed\n";
  // On a stack of its own: what could not grow may be the main thread's.
  static char room[65536];
  const stack_t stack{.ss_sp = room, .ss_flags = 0, .ss_size = sizeof room};
  ::sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = SA_ONSTACK;
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT}) ::sigaction(signal, &action, nullptr);
#endif
}

/// Mesa would make its cache of shaders below a relative path, in the working folder.
void ignore_relative_cache_home() {
  const char* folder = std::getenv("XDG_CACHE_HOME");
  if (folder != nullptr && folder[0] != '/') ::unsetenv("XDG_CACHE_HOME");
}

/// Where Mesa puts it.
void avoid_a_full_shader_cache() {
  const char* named = std::getenv("MESA_SHADER_CACHE_DIR");
  fs::path folder = named != nullptr ? fs::path(named) : cache_home().value_or("");
  struct statvfs disk {};
  while (!folder.empty() && ::statvfs(folder.c_str(), &disk) != 0) {
    if (folder == folder.parent_path()) return;
    folder = folder.parent_path();  // Mesa makes the folders that are missing
  }
  if (folder.empty() || disk.f_frsize * disk.f_bavail >= kLeastCacheRoom) return;
  ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
}

}  // namespace

std::string address_space_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return "";
  return ": the address space is limited to " + std::to_string(limit.rlim_cur / 1'000'000) +
         " MB (ulimit -v)";
}

void expect_machine_limits(const char* program) {
  // A handler, unlike SIG_IGN, is not passed on to programs that this one starts.
  std::signal(SIGXFSZ, [](int) {});
  explain_crashes(program);
  ignore_relative_cache_home();
  avoid_a_full_shader_cache();
}

}  // namespace wobblebench::bench
