// --shard I/N of commands whose work is parted between machines.
#pragma once

#include <string>

namespace wobblebench::bench {

struct Shard {
  int index = 1;  ///< from 1 on
  int count = 1;
};

/// Throws UserError "--shard = TEXT: what is allowed".
Shard parse_shard(const std::string& text);

}  // namespace wobblebench::bench
