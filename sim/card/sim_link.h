// The synthetic probe as a board's link: the bytes that a card would send, when it would.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hw/link/interruptible_wait.h"
#include "hw/link/link.h"
#include "hw/link/pace.h"
#include "sim/card/card_model.h"
#include "sim/card/volume_feed.h"
#include "sim/probe_simulator.h"

namespace wobblebench::sim {

struct SimLinkOptions {
  hw::Pace pace = hw::Pace::asap;
  CardOptions card;
  /// Volumes made before they are sent. 0: read() makes them, and cannot be cancelled meanwhile.
  int volumes_ahead = 1;
};

template <OptionsOf<SimLinkOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  hw::describe_pace(o.pace, v);
  v.integer("volumes_ahead", o.volumes_ahead, 0, 16);
  describe(o.card, v);
}

/// Sticks of any origin: a simulator, or none for studies of what comes after.
struct StickSource {
  hw::AcquisitionPlan plan;
  hw::SampleScale scale = hw::SampleScale::log_compressed;
  VolumeFeed::Make volume;
};
StickSource stick_source(ProbeSimulator simulator);

/// What the link did, for whoever keeps a share of it; written while it is read.
struct SimLinkFigures {
  std::atomic<std::uint64_t> sticks_emitted = 0;   ///< by the probe
  std::atomic<std::uint64_t> packets_dropped = 0;  ///< by the card, whose ring was full
  std::atomic<double> volume_ms = 0;  ///< wall time of making volumes, so that it can be told apart
  /// Realtime: by how much the probe was held up because a volume was not simulated in time.
  std::atomic<double> late_ms = 0;
};

/// Sends `acquisition.volumes` volumes as wire packets through a CardModel. asap: in virtual time,
/// where device time passes only while it is read, so that nothing is lost by reading slowly.
/// realtime: by the host's clock, from the first read on, whether it is read or not; only a probe
/// whose volumes are not simulated in time is held up, which the figures say.
class SimLink : public hw::Link {
 public:
  /// `time` must outlive this; none: the host's clock.
  explicit SimLink(StickSource source,
                   const SimLinkOptions& options = {},
                   std::shared_ptr<SimLinkFigures> figures = {},
                   const hw::HostTimeSource* time = nullptr);

  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override;
  void cancel() override { waiting_.cancel(); }
  void resume() override { waiting_.resume(); }
  void close() override { waiting_.close(); }
  hw::LinkCapabilities capabilities() const override;
  std::string loss() const override { return loss_.empty() ? Link::loss() : loss_; }

 private:
  hw::HostTime now() const { return time_ ? time_->now() : hw::HostClock::now(); }
  hw::ReadResult read_card(std::span<std::byte> buffer, hw::HostTime deadline);
  hw::DeviceTime device_now() const;
  void send_until(hw::DeviceTime time);
  bool next_volume();
  void hold_up(hw::DeviceTime begin, hw::HostTime ready);
  void send_packet();
  void end_volume(std::uint32_t volume);
  hw::DeviceTime next_complete() const;
  hw::HostTime next_event() const;

  const StickSource source_;
  const SimLinkOptions options_;
  const std::shared_ptr<SimLinkFigures> figures_;
  const hw::HostTimeSource* const time_;
  hw::InterruptibleWait waiting_;
  CardModel card_;
  std::string loss_;
  std::uint64_t sequence_ = 0;    ///< of the stick that is sent next
  bool inside_volume_ = false;    ///< its volume's samples are here, its configuration was sent
  bool over_ = false;             ///< all was sent
  VolumeSamples volume_;          ///< of the volume under way
  hw::Stick stick_;               ///< sent last
  std::vector<std::byte> bytes_;  ///< one packet
  std::optional<hw::HostTime> epoch_;  ///< realtime: when device time was 0
  VolumeFeed feed_;                    ///< its thread wakes waiting_, which lives longer
  const hw::DeviceDuration stick_period_;
};

}  // namespace wobblebench::sim
