// Starting other programs.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace wobblebench {

/// Whose signals of the terminal, Ctrl-C say, a program gets.
enum class Session {
  shared,  ///< those of this program
  own      ///< none; it and what it starts are the process group -child
};

/// Starts the program words[0], searched in PATH, with no signal blocked. Open in it are
/// `descriptors` alone, as 0, 1, …; negative: /dev/null. Returns 0, or errno.
int start_program(pid_t& child,
                  std::vector<std::string> words,
                  const std::vector<int>& descriptors,
                  Session session);

}  // namespace wobblebench
