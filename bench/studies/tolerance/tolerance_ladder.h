// The render settings that `run --tolerance` chooses from.
#pragma once

#include <string>
#include <vector>

namespace wobblebench::bench {

/// Keys of a scene, and for each setting their values as in TOML, the fastest first where they were
/// measured (docs/decisions/0036-tolerance.md). None of them changes what a picture shows or how
/// large it is.
struct ToleranceLadder {
  std::vector<std::string> keys;
  std::vector<std::vector<std::string>> settings;
};

const ToleranceLadder& tolerance_ladder();

}  // namespace wobblebench::bench
