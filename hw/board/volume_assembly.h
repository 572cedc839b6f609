// Puts the sticks of a board into frames and volumes.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "hw/board/board.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::hw {

/// Takes the events of a board and returns volumes. A program that needs frames as they come takes
/// the events itself, and has place() and finish_frame() do the rest. Used by one thread, the only
/// one that calls board.next().
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

  /// Sticks that were lost before the first configuration.
  const BoardAccount& before_configuration() const { return before_configuration_; }

  // For programs that take the board's events themselves.

  void configure(const Configuration& configuration) { configuration_ = configuration; }
  /// All sticks of the volume `index` are missing. Throws std::bad_optional_access before the first
  /// configuration.
  void begin_volume(std::uint32_t index);
  /// Copies the stick to its frame and line of the volume under way; where there is none, the
  /// stick's begins. Throws as begin_volume() and PolarVolume::place().
  void place(const Stick& stick);
  /// The volume under way: it was begun, and not taken.
  std::optional<PolarVolume>& volume() { return volume_; }
  const std::optional<PolarVolume>& volume() const { return volume_; }
  std::optional<PolarVolume> take_volume() { return std::exchange(volume_, std::nullopt); }
  /// The stick is of another volume than the one under way.
  bool is_of_another_volume(const Stick& stick) const {
    return volume_ && volume_->volume_index() != stick.index.volume;
  }

  /// Frames of the volume under way that finish_frame() has not returned; 0 without a volume.
  int unfinished_frames() const;
  /// The stick is of the volume under way, of a frame that is fired after the first unfinished one.
  bool is_of_later_frame(const Stick& stick) const;
  /// Returns the first unfinished frame in the order of firing: no more sticks of it will come.
  int finish_frame();

 private:
  /// A frame's number in the order of firing, from its number in the fan; and back.
  int mirrored(int frame) const;

  Board& board_;
  std::optional<Configuration> configuration_;
  BoardAccount before_configuration_;
  std::optional<PolarVolume> volume_;  ///< the one under way
  int finished_frames_ = 0;            ///< of it
  bool ended_ = false;
};

/// Adds the sticks of a gap: emitted, and lost by its cause.
void count_lost(const Gap& gap, BoardAccount& account);

}  // namespace wobblebench::hw
