#include "bench/acquire.h"

#include <atomic>
#include <memory>
#include <stdexcept>

#include "bench/user_error.h"
#include "hw/volume_assembly.h"
#include "sim/sim_link.h"

namespace wobblebench::bench {

namespace {

double milliseconds(hw::HostClock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

/// Longer than any volume takes to arrive; a link that sends nothing for so long has failed.
constexpr std::chrono::minutes kPatience{10};

}  // namespace

BoardArguments parse_board(const std::string& text) {
  if (text != "sim") throw UserError("--board = " + text + ": must be sim");
  return {text};
}

Acquisition acquire(const BoardArguments&, const Scene& scene, const phantoms::Phantom& phantom) {
  if (scene.acquisition.volumes != 1) {
    throw UserError("acquisition.volumes = " + std::to_string(scene.acquisition.volumes) +
                    ": must be 1; this command renders one volume");
  }
  sim::ProbeSimulator simulator(phantom,
                                scene.phantom_placement(),
                                scene.plan(),
                                scene.simulation,
                                scene.phantom_motion(phantom));
  const sim::Fidelity fidelity = simulator.fidelity();
  const auto effects = simulator.effects();
  const double map_ms = simulator.map_ms(), once_ms = simulator.once_ms();

  const auto start = hw::HostClock::now();
  const auto volume_ms = std::make_shared<std::atomic<double>>(0.0);
  hw::Board board(std::make_unique<sim::SimLink>(std::move(simulator), volume_ms));
  board.start();
  hw::VolumeAssembly assembly(board);
  auto volume = assembly.next(hw::HostClock::now() + kPatience);
  const auto delivered = hw::HostClock::now();
  board.stop();
  if (!volume) throw std::runtime_error("--board sim: the board delivered no volume");
  const hw::BoardAccount account = board.account();
  if (!account.balanced()) {
    throw std::logic_error("board account: emitted " + std::to_string(account.emitted) +
                           ", delivered " + std::to_string(account.delivered) + " + lost " +
                           std::to_string(account.lost.total()));
  }
  return {std::move(*volume),
          account,
          std::string(hw::to_string(assembly.configuration()->source)),
          effects,
          fidelity,
          map_ms,
          once_ms,
          *volume_ms,
          milliseconds(delivered - start) - *volume_ms};
}

}  // namespace wobblebench::bench
