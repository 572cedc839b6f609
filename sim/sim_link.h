// The synthetic probe as a board's link: the bytes that a card would send.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include "hw/link.h"
#include "sim/probe_simulator.h"

namespace wobblebench::sim {

/// Serves `acquisition.volumes` volumes as wire packets (configuration, sticks, volume end) as fast
/// as they are read, in virtual time: nothing is lost by reading slowly. A volume is made when its
/// first byte is asked for, so that read() may then take as long as the simulation of one volume.
class SimLink : public hw::Link {
 public:
  /// `volume_ms`, if given, is increased by the wall time of making each volume, so that simulation
  /// can be told from transport.
  explicit SimLink(ProbeSimulator simulator, std::shared_ptr<std::atomic<double>> volume_ms = {});

  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override;
  void cancel() override { cancelled_ = true; }
  void resume() override { cancelled_ = false; }
  void close() override { closed_ = true; }
  hw::LinkCapabilities capabilities() const override;

 private:
  void begin_volume();
  void encode_next();

  ProbeSimulator simulator_;
  std::shared_ptr<std::atomic<double>> volume_ms_;
  std::atomic<bool> cancelled_ = false;
  std::atomic<bool> closed_ = false;
  std::uint64_t sequence_ = 0;    ///< of the stick that is encoded next
  VolumeSamples volume_;          ///< of the volume under way
  std::vector<std::byte> bytes_;  ///< encoded packets …
  std::size_t read_ = 0;          ///< … of which this many were read
};

}  // namespace wobblebench::sim
