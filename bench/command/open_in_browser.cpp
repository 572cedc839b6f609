#include "bench/command/open_in_browser.h"

#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "base/start_program.h"

namespace wobblebench::bench {

namespace {

constexpr std::chrono::milliseconds kPatience{1000}, kAskEvery{10};

std::string failure_of(int status) {
  if (WIFSIGNALED(status)) return std::string("ended by ") + ::strsignal(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : "failed: exit code " + std::to_string(WEXITSTATUS(status));
}

/// Why a program ended soon after its start; empty: it did its work, or is still at it.
std::string early_failure(pid_t child) {
  int status = 0;
  for (auto waited = kPatience * 0; waited < kPatience; waited += kAskEvery) {
    if (::waitpid(child, &status, WNOHANG) != 0) return failure_of(status);
    std::this_thread::sleep_for(kAskEvery);
  }
  std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();  // no zombie stays
  return "";
}

}  // namespace

std::string open_in_browser(const std::filesystem::path& page) {
  return open_address(std::filesystem::absolute(page).string());
}

std::string open_address(const std::string& address) {
  // Without any of them xdg-open tries the browsers of terminals, one of which may wait in silence.
  constexpr const char* kDesktops[] = {"DISPLAY", "WAYLAND_DISPLAY", "BROWSER"};
  if (std::ranges::none_of(kDesktops, [](const char* name) {
        const char* const value = std::getenv(name);
        return value != nullptr && *value != '\0';
      })) {
    return "--open: there is no desktop (neither DISPLAY, WAYLAND_DISPLAY nor BROWSER is set); the "
           "page is " +
           address;
  }
  // A browser's messages are not ours; it may outlive this program, and a pipe that reads our
  // output.
  pid_t child = 0;
  const int error = start_program(child, {"xdg-open", address}, {-1, -1, -1}, Session::own);
  const std::string failure =
      error != 0 ? std::string("cannot be started: ") + std::strerror(error) : early_failure(child);
  return failure.empty() ? "" : "--open: xdg-open " + failure + "; the page is " + address;
}

}  // namespace wobblebench::bench
