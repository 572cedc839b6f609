// Assembles the events of a board into volumes.
#pragma once

#include <optional>

#include "hw/board/board.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::hw {

/// Takes the events of a board and returns volumes. Used by one thread, the only one that calls
/// board.next().
///
/// @code
/// #include "hw/recording/file_link.h"
/// hw::Board board(std::make_unique<hw::FileLink>("scan.wbst"));
/// board.start();
/// hw::VolumeAssembly assembly(board);
/// while (const auto volume = assembly.next(hw::HostTime::max())) {
///   if (volume->missing_sticks() > 0) board.stop();
/// }
/// @endcode
class VolumeAssembly {
 public:
  /// `board` must outlive this.
  explicit VolumeAssembly(Board& board) : board_(board) {}

  /// Waits for the plan, without taking a stick: true once configuration() is set. False if
  /// `deadline` passed first or the board was cancelled, or if ended().
  [[nodiscard]] bool wait_for_configuration(HostTime deadline);

  /// The next volume of which at least one stick arrived; lost sticks are marked in it. Also a
  /// volume that the end of the stream truncates. None if `deadline` passed first or the board was
  /// cancelled (the sticks so far are kept for the next call), or if ended().
  [[nodiscard]] std::optional<PolarVolume> next(HostTime deadline);

  /// The board returned EndOfStream, DeviceLost or Stopped, and board.next() returns it again: no
  /// volume will come unless the board is started anew.
  bool ended() const { return ended_; }
  /// The plan and source in force; unset before the first configuration.
  const std::optional<Configuration>& configuration() const { return configuration_; }

 private:
  std::optional<PolarVolume> add(const Stick& stick);

  Board& board_;
  std::optional<Configuration> configuration_;
  std::optional<PolarVolume> volume_;  ///< the current one, with at least one stick
  bool ended_ = false;
};

}  // namespace wobblebench::hw
