// The synthetic probe behind a capture card, as a link: its bytes, and when they arrive.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hw/link/link.h"
#include "hw/wire/configuration.h"
#include "sim/options.h"
#include "sim/probe_simulator.h"

namespace wobblebench::sim {

struct SimLinkOptions {
  hw::Pace pace = hw::Pace::asap;
  CardOptions card;
  /// Sticks of this number of volumes are computed before they are sent. 0: read() computes them,
  /// and cannot be cancelled meanwhile.
  int volumes_ahead = 1;
  int first_volume = 0;  ///< that is sent; the scene's `volumes` count from it
};

template <OptionsOf<SimLinkOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  hw::describe_pace(o.pace, v);
  v.integer("volumes_ahead", o.volumes_ahead, 0, 16);
  v.integer("first_volume", o.first_volume, 0, hw::kMostVolumes - 1);
  describe(o.card, v);
}

/// Makes the samples of a block: stick after stick in the order of firing, whole frames of one
/// volume, from the stick `first_sequence` on, which is the first of a frame.
using MakeBlock = std::function<std::vector<float>(std::uint64_t first_sequence)>;

/// Where the link's sticks come from: a simulator, or a pattern for studies without one.
struct StickSource {
  hw::AcquisitionPlan plan;
  hw::SampleScale scale = hw::SampleScale::log_compressed;
  MakeBlock block;  ///< called for one block after the other
  // Put into each configuration.
  hw::SubjectHash subject = {};
  hw::DisplayScale display_scale = {};
};
/// Blocks are those of ProbeSimulator::block(). `iq`, if given, takes the IQ samples, as
/// ProbeSimulator::volume() says; a block is then a whole volume, so that where the sink throws no
/// stick of that volume is sent.
StickSource stick_source(ProbeSimulator simulator,
                         const hw::SubjectHash& subject = {},
                         const IqSink& iq = {});

/// Counts and times of a link, which may be read while the link writes them.
struct SimLinkStatistics {
  std::atomic<std::uint64_t> sticks_emitted = 0;   ///< by the probe
  std::atomic<std::uint64_t> packets_dropped = 0;  ///< by the card, when its ring is full
  std::atomic<double> volume_ms = 0;               ///< wall time of computing the volumes' sticks
  /// Realtime: total delay of the probe by volumes that were not computed in time.
  std::atomic<double> late_ms = 0;
};

/// Sends `acquisition.volumes` volumes from `first_volume` on, at the device times that they have
/// in a stream from volume 0, as wire packets through a CardModel. asap: in virtual time, where
/// device time passes only while the link is read, so that slow reading loses nothing; sticks are
/// sent while the following blocks of their volume are computed. realtime: by the host's clock from
/// the first read on, on a thread of its own (not with `time`), whether the link is read or not:
/// packets that find the card's ring full are dropped. A probe does not pause within a volume: the
/// link waits until the whole volume is computed, and only a volume that is not computed in time
/// delays the probe, as the statistics report.
///
/// @code
/// #include "hw/board/board.h"
/// const auto phantom = phantoms::make_phantom({.name = "sphere"});
/// const auto placed = phantoms::still_at(phantom, phantom.suggested_position_m());
/// const sim::ProbeSimulator simulator(placed, hw::AcquisitionPlan({}, {}), {});
/// hw::Board board(std::make_unique<sim::SimLink>(
///     sim::stick_source(simulator), sim::SimLinkOptions{.pace = hw::Pace::realtime}));
/// board.start();
/// @endcode
class SimLink : public hw::Link {
 public:
  /// `time` must outlive the link; null: the host's clock.
  explicit SimLink(StickSource source,
                   const SimLinkOptions& options = {},
                   std::shared_ptr<SimLinkStatistics> statistics = {},
                   const hw::HostTimeSource* time = nullptr);
  ~SimLink() override;

  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override;
  void cancel() override;
  void resume() override;
  void close() override;
  hw::LinkCapabilities capabilities() const override;
  std::optional<hw::HostTime> epoch() const override;
  std::string loss() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::sim
