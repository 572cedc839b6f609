#include "bench/pipeline/acquire.h"

#include <stdexcept>
#include <utility>

#include "base/user_error.h"
#include "bench/pipeline/whole_volume.h"
#include "bench/scene/adopt_plan.h"
#include "bench/scene/subject_hash.h"

namespace wobblebench::bench {

namespace {

double milliseconds(hw::HostClock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

void check_balance(const hw::BoardAccount& account) {
  if (account.balanced()) return;
  throw std::logic_error("board account: emitted " + std::to_string(account.emitted) +
                         ", delivered " + std::to_string(account.delivered) + " + lost " +
                         std::to_string(account.lost.total()));
}

/// Over which linear envelopes are displayed: the scene's choice, or else the stream's.
double dynamic_range_db(const Scene& scene, const hw::Configuration& configuration) {
  const bool is_chosen = scene.given.contains("simulation.dynamic_range_db");
  const hw::DisplayScale& scale = configuration.display_scale;
  return scale.stated() && !is_chosen ? scale.dynamic_range_db : scene.simulation.dynamic_range_db;
}

}  // namespace

BoardConnection::BoardConnection(const BoardArguments& arguments, const hw::BoardOptions& options)
    : arguments_(arguments), options_(options) {
  if (!is_simulated(arguments)) open();
}

void BoardConnection::open() {
  board_ = std::make_unique<hw::Board>(open_board_link(arguments_, {}), options_);
  assembly_.emplace(*board_);
}

hw::StreamOrigin BoardConnection::adopt_plan(Scene& scene) {
  if (is_simulated(arguments_)) return hw::StreamOrigin::simulated;
  board_->start();
  if (!assembly_->wait_for_configuration(hw::HostClock::now() + kVolumeTimeout)) {
    throw std::runtime_error("--board " + arguments_.text + ": no configuration came; " + ending());
  }
  // Sticks that a source at its own pace sends until acquire() are missed, and counted.
  board_->stop();
  const std::string board = "--board " + arguments_.text;
  const hw::Configuration& configuration = *assembly_->configuration();
  bench::adopt_plan(scene, configuration.plan, board);
  if (configuration.source == hw::StreamOrigin::simulated) {
    refuse_other_subject(scene, configuration.subject, /*placed=*/false, board);
  }
  return configuration.source;
}

sim::ProbeSimulator BoardConnection::simulator(const Scene& scene,
                                               const phantoms::PlacedPhantom& subject,
                                               const sim::TissueMapSource& maps) {
  sim::ProbeSimulator simulator(subject, scene.plan(), scene.simulation, maps);
  simulated_ = SimulatedVolume{.effects = simulator.effects(),
                               .fidelity = simulator.fidelity(),
                               .map_ms = simulator.map_ms(),
                               .once_ms = simulator.once_ms()};
  return simulator;
}

hw::Board& BoardConnection::connect(const Scene& scene,
                                    const phantoms::PlacedPhantom& subject,
                                    const sim::TissueMapSource& maps) {
  if (!is_simulated(arguments_)) {
    if (assembly_->configuration()) {
      const std::string source = "--board " + arguments_.text;
      refuse_other_subject(scene, assembly_->configuration()->subject, /*placed=*/true, source);
    }
    return connect();
  }
  sim::ProbeSimulator made = simulator(scene, subject, maps);
  // The link computes its volumes from here on.
  connected_ = hw::HostClock::now();
  const auto sticks = [&] { return sim::stick_source(std::move(made), subject_hash(scene)); };
  board_ = std::make_unique<hw::Board>(open_board_link(arguments_, sticks, figures_), options_);
  assembly_.emplace(*board_);
  return *board_;
}

hw::Board& BoardConnection::connect() {
  connected_ = hw::HostClock::now();
  // A device lost while its plan was read is opened once more: a recording can always be reopened,
  // a card may be back.
  if (board_->state() == hw::BoardState::lost) open();
  return *board_;
}

Acquisition BoardConnection::acquire(const Scene& scene,
                                     const phantoms::PlacedPhantom& subject,
                                     const sim::TissueMapSource& maps) {
  if (is_simulated(arguments_) && scene.acquisition.volumes != 1) {
    throw UserError("acquisition.volumes = " + std::to_string(scene.acquisition.volumes) +
                    ": must be 1; this command renders one volume");
  }
  connect(scene, subject, maps);
  return receive(scene);
}

Acquisition BoardConnection::acquire(const Scene& scene) {
  connect();
  return receive(scene);
}

std::optional<SimulatedVolume> BoardConnection::simulated() const {
  std::optional<SimulatedVolume> simulated = simulated_;
  if (simulated) {
    simulated->volume_ms = figures_->volume_ms;
    simulated->late_ms = figures_->late_ms;
    simulated->packets_dropped = figures_->packets_dropped;
  }
  return simulated;
}

Acquisition BoardConnection::receive(const Scene& scene) {
  board_->start();
  hw::PolarVolume volume = whole_volume(*board_, *assembly_, arguments_.text);
  const auto delivered = hw::HostClock::now();
  const hw::Configuration configuration = *assembly_->configuration();
  const ReceivedSamples samples = make_displayable(
      volume, configuration.source, dynamic_range_db(scene, configuration), arguments_.text);
  Acquisition acquisition{.volume = std::move(volume),
                          .samples = samples,
                          .account = {},
                          .damage = {},
                          .link = board_->capabilities(),
                          .source = configuration.source,
                          .subject = configuration.subject,
                          .display_scale = configuration.display_scale,
                          .simulated = {},
                          .ending = assembly_->ended() ? ending() : ""};
  board_->stop();
  acquisition.account = board_->account();
  acquisition.damage = board_->damage();
  check_balance(acquisition.account);
  acquisition.simulated = simulated();
  acquisition.transport_ms = milliseconds(delivered - connected_) - figures_->volume_ms;
  return acquisition;
}

std::string BoardConnection::ending() {
  return ending_of(*board_, *assembly_);
}

}  // namespace wobblebench::bench
