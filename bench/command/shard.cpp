#include "bench/command/shard.h"

#include <cstdio>

#include "base/user_error.h"

namespace wobblebench::bench {

Shard parse_shard(const std::string& text) {
  constexpr int kMostShards = 10000;
  Shard shard;
  char end = 0;
  const bool read = std::sscanf(text.c_str(), "%5d/%5d%c", &shard.index, &shard.count, &end) == 2;
  const bool allowed = read && shard.index >= 1 && shard.index <= shard.count &&
                       shard.count <= kMostShards &&
                       text == std::to_string(shard.index) + "/" + std::to_string(shard.count);
  if (!allowed) {
    throw UserError("--shard = " + text + ": must be I/N, 1 to N, with N at most " +
                    std::to_string(kMostShards));
  }
  return shard;
}

}  // namespace wobblebench::bench
