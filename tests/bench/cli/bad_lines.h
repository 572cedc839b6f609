// Random command lines, each wrong in one known way.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/command/program.h"

namespace wobblebench::bench::testing {

struct BadLine {
  std::vector<std::string> words;  ///< without the program's name
  std::string why;
  std::string says;  ///< what the refusal must hold: the option or the file that is wrong
};

/// Makes the files that lines name in the folder where they are run: wrong scenes, a whole
/// recording, a folder, a FIFO and the like.
void make_named_files(const std::filesystem::path& folder);

/// Lines from the program's own description of its options: one word or value of each is wrong, the
/// others are right.
class BadLines {
 public:
  /// `takes_sim`: whether the program's --board may be "sim".
  BadLines(const Program& program, bool takes_sim, std::uint64_t seed);
  ~BadLines();
  BadLine next();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::bench::testing
