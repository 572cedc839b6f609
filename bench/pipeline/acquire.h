// From a scene and --board to a polar volume, through the board that real hardware would use.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/cache/phantom_cache.h"
#include "bench/output/progress.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/stream/stream.h"
#include "bench/scene/resolved_scene.h"
#include "bench/scene/scene.h"
#include "hw/board/board.h"
#include "hw/probe/polar_volume.h"
#include "sim/fidelity.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

/// The simulator's report on the volume that it made.
struct SimulatedVolume {
  std::vector<std::string> effects;  ///< which ran
  sim::Fidelity fidelity;            ///< the rung that was chosen, and why
  double map_ms = 0;                 ///< once a phantom: its tissue map, made or read
  double once_ms = 0;    ///< once a scene: speckle, echoes that are the same in each volume
  double volume_ms = 0;  ///< each volume: the rest of the echoes, and the receive chain
  double late_ms = 0;    ///< pace=realtime: how long the probe waited for its samples
  std::uint64_t packets_dropped = 0;  ///< by the modelled card
};

struct Acquisition {
  hw::PolarVolume volume;    ///< its samples as the renderer takes them
  ReceivedSamples samples;   ///< as they came
  hw::BoardAccount account;  ///< to the end of the volume
  hw::BoardAccount read;     ///< of all that the board had read when it was stopped
  hw::WireDamage damage;
  hw::LinkCapabilities link;
  hw::StreamOrigin source;                   ///< of the samples
  hw::SubjectHash subject;                   ///< what they are of, if the stream says so
  hw::DisplayScale display_scale;            ///< how they were made, if the stream says so
  std::optional<SimulatedVolume> simulated;  ///< none: the sticks come from a recording or a card
  /// Encode, link, decode, ring, assembly: all of the time to the last stick but the simulator's.
  double transport_ms = 0;
  double off_plan_s = 0;    ///< ReaderStatistics::off_plan_s
  std::string ending;       ///< why the stream broke off; empty: it did not
  std::string board;        ///< what --board was given
  bool knows_times = true;  ///< hw::Configuration::knows_times
};

/// One board: of --board, or of the scene's simulator.
class BoardConnection {
 public:
  /// Opens a recording or a card; a simulator is made by connect(). Throws UserError.
  explicit BoardConnection(const BoardArguments& arguments, const hw::BoardOptions& options = {});

  /// The scene with the board's probe, acquisition and display scale (a simulator has the scene's
  /// own), and with its phantom where the samples are of it: step "phantom". Warns of options that
  /// are given and without effect. Throws UserError where the scene was given other values or is of
  /// another subject, NothingCame if no configuration comes.
  ResolvedScene resolve(const Scene& given, PhantomCache& cache, Progress& progress);

  /// A simulator makes all of the scene's volumes, from now on. `maps`, `echoes`: as
  /// sim::ProbeSimulator takes them. The result is valid as long as this. Throws UserError for a
  /// recording of a subject at another place.
  StreamSource connect(const ResolvedScene& scene,
                       const sim::TissueMapSource& maps = {},
                       const sim::EchoStore& echoes = {});

  /// stream_one_volume() of what connect() returned.
  [[nodiscard]] Acquisition acquire(const StreamSource& source,
                                    StreamRenderer& renderer,
                                    const PictureSink& sink);
  /// The same, without a picture. Throws UserError for a simulated scene of several volumes.
  [[nodiscard]] Acquisition acquire(const ResolvedScene& scene,
                                    const sim::TissueMapSource& maps = {});

  /// left_out_warning() of its link.
  std::string left_out() const { return left_out_warning(arguments_); }
  /// Throws UserError for a simulated scene of several volumes.
  void check_one_volume(const Scene& scene) const;
  /// The simulator's report on the volumes so far, times as sums; none: sticks come from elsewhere.
  std::optional<SimulatedVolume> simulated() const;

 private:
  void open();
  std::string name() const { return "--board " + arguments_.text; }
  sim::ProbeSimulator simulator(const ResolvedScene& scene,
                                const sim::TissueMapSource& maps,
                                const sim::EchoStore& echoes);
  StreamSource source(const ResolvedScene& scene);

  BoardArguments arguments_;
  hw::BoardOptions options_;
  std::unique_ptr<hw::Board> board_;
  std::optional<hw::Configuration> configuration_;  ///< of a recording or a card
  hw::BoardAccount before_configuration_;           ///< sticks lost before it
  hw::HostTime connected_;                          ///< from then on sticks may be made
  std::optional<SimulatedVolume> simulated_;
  std::shared_ptr<sim::SimLinkStatistics> figures_ = std::make_shared<sim::SimLinkStatistics>();
};

/// The simulator's volume of a scene.
inline Acquisition acquire_simulated(const ResolvedScene& scene,
                                     const sim::TissueMapSource& maps = {}) {
  return BoardConnection(parse_board("sim")).acquire(scene, maps);
}

}  // namespace wobblebench::bench
