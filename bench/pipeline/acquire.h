// From a scene and --board to a polar volume, through the board that real hardware would use.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/board_link.h"
#include "bench/scene/scene.h"
#include "hw/board/board.h"
#include "hw/board/volume_assembly.h"
#include "hw/probe/polar_volume.h"
#include "phantoms/placed_phantom.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

/// What the simulator says about the volume that it made.
struct SimulatedVolume {
  std::vector<std::string> effects;   ///< which ran
  sim::Fidelity fidelity;             ///< the rung that it took, and why
  double map_ms = 0;                  ///< once for a phantom: its tissue map
  double once_ms = 0;                 ///< once for a scene: even speckle, echoes that stay the same
  double volume_ms = 0;               ///< for each volume: what changes, and the receive chain
  double late_ms = 0;                 ///< realtime: how long the probe waited for its samples
  std::uint64_t packets_dropped = 0;  ///< by the modelled card
};

struct Acquisition {
  hw::PolarVolume volume;
  hw::BoardAccount account;
  hw::WireDamage damage;
  hw::LinkCapabilities link;
  hw::StreamOrigin source;                   ///< what made the samples
  std::optional<SimulatedVolume> simulated;  ///< none: the sticks come from outside
  double transport_ms = 0;                   ///< encode, link, decode, ring, assembly
  std::string ending;                        ///< why the stream broke off; empty: it did not
};

/// One board for one volume.
class BoardConnection {
 public:
  /// Opens a link to the outside; the simulator's comes later. Throws UserError.
  explicit BoardConnection(const BoardArguments& arguments);

  /// Takes over what the board says of probe and acquisition; nothing for the simulator. Throws
  /// UserError where the scene was given something else, std::runtime_error if no plan comes.
  void adopt_plan(Scene& scene);

  /// The first volume whose beginning was not missed. Throws UserError where the scene asks the
  /// simulator for several, std::runtime_error if there is none.
  Acquisition acquire(const Scene& scene, const phantoms::PlacedPhantom& subject);

 private:
  void open();
  void simulate(const Scene& scene, const phantoms::PlacedPhantom& subject);
  std::string ending();

  BoardArguments arguments_;
  std::unique_ptr<hw::Board> board_;
  std::optional<hw::VolumeAssembly> assembly_;
  std::optional<SimulatedVolume> simulated_;
  std::shared_ptr<sim::SimLinkStatistics> figures_ = std::make_shared<sim::SimLinkStatistics>();
};

/// The simulator's volume of a scene.
inline Acquisition acquire_simulated(const Scene& scene, const phantoms::Phantom& phantom) {
  return BoardConnection(parse_board("sim")).acquire(scene, scene.place(phantom));
}

}  // namespace wobblebench::bench
