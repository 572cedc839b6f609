// The first whole volume of a board that may have been joined under way.
#pragma once

#include <chrono>
#include <stdexcept>
#include <string>

#include "hw/board/board.h"
#include "hw/board/volume_assembly.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// Longer than any volume takes to arrive; a link that sends nothing for so long has failed.
inline constexpr std::chrono::minutes kPatience{10};

/// what() is "--board ARGS: no volume came; WHY".
class NoVolume : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The first volume whose beginning was not missed; of a stream that holds no other, one that was
/// joined under way. `arguments`: of --board. Throws NoVolume.
hw::PolarVolume whole_volume(hw::Board& board,
                             hw::VolumeAssembly& assembly,
                             const std::string& arguments);

/// What the board says at the end of its stream.
std::string ending_of(hw::Board& board, const hw::VolumeAssembly& assembly);

}  // namespace wobblebench::bench
