// Events of a board, put together to volumes.
#pragma once

#include <optional>

#include "hw/board/board.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::hw {

/// Takes a board's events and gives its volumes. One thread uses it, and alone calls board.next().
class VolumeAssembly {
 public:
  /// `board` must outlive this.
  explicit VolumeAssembly(Board& board) : board_(board) {}

  /// Waits for the plan, without taking a stick: true once configuration() is set. False if
  /// `deadline` passed first or the board was cancelled, or if ended().
  bool wait_for_configuration(HostTime deadline);

  /// The next volume of which at least one stick arrived; lost sticks are marked in it. A volume
  /// that the end of the stream cuts short is given too. None if `deadline` passed first or the
  /// board was cancelled (what has arrived is kept for the next call), or if ended().
  std::optional<PolarVolume> next(HostTime deadline);

  /// The board gave EndOfStream, DeviceLost or Stopped, and board.next() says again which: unless
  /// it is started anew, no volume will come.
  bool ended() const { return ended_; }
  /// The plan and source in force; unset before the first configuration.
  const std::optional<Configuration>& configuration() const { return configuration_; }

 private:
  std::optional<PolarVolume> place(const Stick& stick);

  Board& board_;
  std::optional<Configuration> configuration_;
  std::optional<PolarVolume> volume_;  ///< under way, with a stick at least
  bool ended_ = false;
};

}  // namespace wobblebench::hw
