// From a scene and --board to a polar volume, through the board that real hardware would use.
#pragma once

#include <string>
#include <vector>

#include "bench/scene.h"
#include "hw/board.h"
#include "hw/polar_volume.h"
#include "phantoms/phantom.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

/// --board ARGS: a link's name, then ",key=value" pairs. Today: "sim".
struct BoardArguments {
  std::string link = "sim";
};

/// Throws UserError "--board = ARGS: must be sim".
BoardArguments parse_board(const std::string& text);

struct Acquisition {
  hw::PolarVolume volume;
  hw::BoardAccount account;
  std::string provenance;            ///< of the samples: "simulated", …
  std::vector<std::string> effects;  ///< which the simulator ran
  sim::Fidelity fidelity;            ///< the rung that it took, and why
  double map_ms = 0;                 ///< once for a phantom: its tissue map
  double once_ms = 0;                ///< once for a scene: even speckle, echoes that stay the same
  double volume_ms = 0;              ///< for each volume: what changes, and the receive chain
  double transport_ms = 0;           ///< encode, link, decode, ring, assembly
};

/// The scene's volume. Throws UserError where the scene asks for several.
Acquisition acquire(const BoardArguments& board,
                    const Scene& scene,
                    const phantoms::Phantom& phantom);

}  // namespace wobblebench::bench
