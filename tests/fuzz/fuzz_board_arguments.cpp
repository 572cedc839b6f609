// Any text as --board: parsed, or refused in one line that names the option.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "base/user_error.h"
#include "bench/pipeline/board_link.h"

namespace bench = wobblebench::bench;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const bench::BoardArguments board = bench::parse_board(text);
    if (board.link.link.empty()) std::abort();
  } catch (const wobblebench::UserError& error) {
    const std::string line = error.what();
    if (line.find('\n') != std::string::npos || !line.starts_with("--board = ")) std::abort();
  }
  return 0;
}
