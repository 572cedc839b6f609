// From the events of a board to the frames of a stream.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bench/pipeline/stream/stream_frame.h"
#include "bench/pipeline/stream/volume_queue.h"
#include "hw/board/board.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

struct ReaderStatistics {
  std::uint64_t sticks = 0;       ///< taken from the board
  std::uint64_t left_sticks = 0;  ///< of volumes whose beginning was missed, and of the last frame
  std::uint64_t volumes = 0;      ///< whose last frame was pushed
  double busy_ms = 0;             ///< neither waiting for the board nor for the queue
  int least_free_slots = 0;       ///< of the board's ring
};

/// Takes the events of a board and pushes each frame as soon as its last line is here, or a later
/// stick is. Frames of which no stick arrived are pushed, too, so that each volume has them all. A
/// volume whose first stick was missed is left out. Used by one thread, the only one that calls
/// board.next().
class FrameReader {
 public:
  /// `board` and `queue` must outlive it. `source`: --board, for refusals.
  FrameReader(hw::Board& board,
              const hw::AcquisitionPlan& plan,
              VolumeQueue& queue,
              std::string source);

  /// Reads until the stream is over, cancelled or stopped, `volumes` volumes were read (0: any
  /// number), or the queue was stopped; closes the queue. Throws UserError for samples that cannot
  /// be displayed, std::runtime_error for a plan that changes and for a device that is lost.
  void run(std::uint64_t volumes);

  const ReaderStatistics& statistics() const { return statistics_; }

 private:
  void read(std::uint64_t volumes);
  /// False: nothing more is wanted, or can come.
  bool take(hw::Event& event);
  bool take_stick(const hw::Stick& stick);
  bool begin_volume(const hw::Stick& stick);
  bool end_volume();
  bool push_frame(bool ends_volume);
  void set_schedule();
  /// Place of a frame in the order of acquisition, and back.
  int place(int frame, std::uint32_t volume) const;
  void leave_volume();

  hw::Board& board_;
  const hw::AcquisitionPlan plan_;
  VolumeQueue& queue_;
  const std::string source_;
  ReaderStatistics statistics_;
  std::optional<hw::PolarVolume> volume_;  ///< under way
  std::optional<std::uint32_t> missed_;    ///< the first volume, where its beginning was missed
  int next_ = 0;                           ///< place of the frame that is pushed next
  StreamFrame frame_;                      ///< that frame, without its samples
  bool checked_ = false;                   ///< the samples of the first whole volume
};

}  // namespace wobblebench::bench
