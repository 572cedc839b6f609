#include "bench/command/open_in_browser.h"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <array>
#include <cstring>

namespace wobblebench::bench {

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
  if (error == 0) return "";
  return std::string("--open: xdg-open cannot be started: ") + std::strerror(error) +
         "; the page is " + place;
}

}  // namespace wobblebench::bench
