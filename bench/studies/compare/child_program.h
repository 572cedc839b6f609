// Another program, run to its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobblebench::bench {

struct ChildEnd {
  int exit_code = 0;       ///< of a signal: 128 + its number
  std::string last_error;  ///< the last line on stderr
};

/// Runs `program` with the arguments and waits. Its stdout is dropped. It is ended by SIGTERM when
/// this process ends. Throws std::runtime_error where it cannot be started.
ChildEnd run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments);

/// What it prints on stdout. Throws as run_child(), and where its exit code is not 0.
std::string output_of_child(const std::filesystem::path& program,
                            const std::vector<std::string>& arguments);

}  // namespace wobblebench::bench
