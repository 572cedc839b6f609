// The first whole volume of a board whose stream may have begun earlier.
#pragma once

#include <chrono>
#include <stdexcept>
#include <string>

#include "hw/board/board.h"
#include "hw/board/volume_assembly.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// Longer than any volume takes to arrive.
inline constexpr std::chrono::minutes kVolumeTimeout{10};

/// what() is "--board ARGS: no volume came; WHY".
class NoVolume : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The first volume with its first stick; if the stream ends before there is one, the incomplete
/// volume. `arguments`: of --board. Throws NoVolume.
hw::PolarVolume whole_volume(hw::Board& board,
                             hw::VolumeAssembly& assembly,
                             const std::string& arguments);

/// Why the stream ended.
std::string ending_of(hw::Board& board, const hw::VolumeAssembly& assembly);

}  // namespace wobblebench::bench
