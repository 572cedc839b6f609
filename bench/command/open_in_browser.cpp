#include "bench/command/open_in_browser.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstring>
#include <thread>

namespace wobblebench::bench {

namespace {

constexpr std::chrono::milliseconds kPatience{1000}, kAskEvery{10};

/// Why a program ended soon after its start; empty: it did its work, or is still at it.
std::string early_failure(pid_t child) {
  int status = 0;
  for (auto waited = kPatience * 0; waited < kPatience; waited += kAskEvery) {
    if (::waitpid(child, &status, WNOHANG) != 0) break;
    std::this_thread::sleep_for(kAskEvery);
  }
  if (WIFSIGNALED(status)) return std::string("ended by ") + ::strsignal(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : "failed: exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::string open_in_browser(const std::filesystem::path& page) {
  return open_address(std::filesystem::absolute(page).string());
}

std::string open_address(const std::string& address) {
  std::string program = "xdg-open", place = address;
  const std::array<char*, 3> words = {program.data(), place.data(), nullptr};
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  // A browser's messages are not ours, and it may outlive a pipe that reads our output.
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_WRONLY, 0);
  }
  pid_t child = 0;
  const int error =
      ::posix_spawnp(&child, program.c_str(), &actions, nullptr, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  const std::string failure =
      error != 0 ? std::string("cannot be started: ") + std::strerror(error) : early_failure(child);
  return failure.empty() ? "" : "--open: xdg-open " + failure + "; the page is " + place;
}

}  // namespace wobblebench::bench
