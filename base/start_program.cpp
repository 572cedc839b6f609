#include "base/start_program.h"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <csignal>

namespace wobblebench {

int start_program(pid_t& child,
                  std::vector<std::string> words,
                  const std::vector<int>& descriptors,
                  Session session) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  int number = 0;
  for (const int descriptor : descriptors) {
    if (descriptor < 0) {
      ::posix_spawn_file_actions_addopen(&files, number++, "/dev/null", O_RDWR, 0);
    } else {
      ::posix_spawn_file_actions_adddup2(&files, descriptor, number++);
    }
  }
  // Libraries open sockets and files that an exec() would keep.
  ::posix_spawn_file_actions_addclosefrom_np(&files, number);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t none;
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  const int flags = session == Session::own ? POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID
                                            : POSIX_SPAWN_SETSIGMASK;
  ::posix_spawnattr_setflags(&attributes, static_cast<short>(flags));
  const int error =
      ::posix_spawnp(&child, pointers.front(), &files, &attributes, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&attributes);
  return error;
}

}  // namespace wobblebench
