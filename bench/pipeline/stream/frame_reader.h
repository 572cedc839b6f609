// From the events of a board to the frames of a stream.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/pipeline/stream/stream_queues.h"
#include "bench/pipeline/stream/stream_source.h"
#include "hw/board/volume_assembly.h"
#include "hw/probe/motor_deviation.h"
#include "hw/probe/polar_volume.h"
#include "hw/wire/account.h"

namespace wobblebench::bench {

struct ReaderStatistics {
  std::uint64_t sticks = 0;       ///< taken from the board
  hw::BoardAccount account;       ///< to the end of the last wanted volume; no duplicates
  std::uint64_t left_sticks = 0;  ///< of volumes whose beginning was missed, and of the last frame
  std::uint64_t volumes = 0;      ///< whose last frame was pushed
  double busy_ms = 0;             ///< neither waiting for the board nor for the queue
  int least_free_slots = 0;       ///< of the board's ring
  std::uint64_t clamped = 0;      ///< samples that were not in [0, 1]
  hw::MotorDeviation motor;       ///< of the sticks of `volumes`
  double off_plan_s = 0;          ///< most that a stick's device time, after the first one's, left
                                  ///< the plan's
  std::string ending;             ///< why nothing more came; empty: it was not read to its end
};

/// A volume as the renderer got it, and what it came as.
struct KeptVolume {
  hw::PolarVolume volume;
  ReceivedSamples samples;
  hw::Configuration configuration;
};

/// Takes the events of a board, has hw::VolumeAssembly place the sticks, notes the times, and
/// pushes each frame as soon as its last line is here, or a later stick is. Frames of which no
/// stick arrived are pushed, too, so that each volume has them all. A first volume whose first
/// stick was missed is left out, unless the stream ends with it. Frames of linear envelopes wait
/// for the end of their volume, and are log-compressed. Used by one thread, the only one that calls
/// board.next().
class FrameReader {
 public:
  /// `source` and `queue` must outlive it. `volumes`: how many are wanted; 0: any number.
  /// `keep_volume`: kept() is the last one.
  FrameReader(const StreamSource& source,
              VolumeQueue& queue,
              std::uint64_t volumes,
              bool keep_volume);

  /// Reads until the stream is over, cancelled or stopped, all wanted volumes were read and the
  /// event behind them, or the queue was stopped; closes the queue. Throws UserError for samples
  /// that cannot be displayed and for another subject, std::runtime_error for a plan or a display
  /// scale that changes and for a device that is lost.
  void run();

  const ReaderStatistics& statistics() const { return statistics_; }
  std::optional<KeptVolume>& kept() { return kept_; }

 private:
  void read();
  bool has_all() const { return volumes_ > 0 && statistics_.volumes >= volumes_; }
  /// False: nothing more is wanted, or can come.
  bool take(hw::Event& event);
  void count(const hw::Gap& gap);
  bool take_behind_last(const hw::Event& event);
  bool take_configuration(hw::Configuration configuration);
  bool take_stick(const hw::StickSlot& slot);
  void note_time(const hw::Stick& stick);
  void begin_volume(const hw::Stick& stick);
  bool end_volume();
  void end_stream(const std::string& why);
  bool finish_frame();
  bool push_frames();
  void check_motor();
  void check_samples();
  void finish_volume();
  void set_times();
  void leave_volume();

  const StreamSource& source_;
  const hw::AcquisitionPlan& plan_;
  VolumeQueue& queue_;
  const std::uint64_t volumes_;
  const bool keeps_volume_;
  ReaderStatistics statistics_;
  hw::VolumeAssembly assembly_;
  std::vector<StreamFrame> finished_;   ///< of the volume under way, not pushed yet; no samples
  StreamFrame frame_;                   ///< the frame under way, without its samples
  std::optional<double> late_s_;        ///< of the acquisition's first stick, by the plan
  bool has_begun_ = false;              ///< a volume did
  bool is_first_stick_missed_ = false;  ///< of the volume under way, the first of the stream
  bool is_checked_ = false;             ///< the samples of the first whole volume
  ReceivedSamples samples_;             ///< of the last volume that was checked
  std::optional<KeptVolume> kept_;
};

/// The frames of a source for callers on any threads. Read from the first call on, on a thread of
/// its own that waits for the callers: frames are dropped by a card alone, and counted.
class FrameSource {
 public:
  /// `open` is called once it is read, and again where it threw.
  explicit FrameSource(std::function<StreamSource()> open) : open_(std::move(open)) {}
  ~FrameSource() { stop(); }
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  /// None: the stream is over. Throws what ended it.
  std::optional<StreamFrame> next();
  /// Gives `take` the frames up to the end of a volume, of which no other caller gets one. False:
  /// the stream is over. Throws what ended it.
  bool next_volume(const std::function<void(const StreamFrame&)>& take);
  /// Ends the calls of other threads, and the stream.
  void stop();
  /// None before the first frame was asked for.
  std::optional<hw::BoardAccount> account() const;

 private:
  void start();
  std::optional<StreamFrame> read_frame();  ///< with reading_

  const std::function<StreamSource()> open_;
  std::mutex reading_;           ///< of those that call next…()
  mutable std::mutex starting_;  ///< of what follows
  bool is_stopped_ = false;
  std::optional<StreamSource> source_;
  std::optional<VolumeQueue> queue_;
  std::exception_ptr failure_;  ///< of the thread, once that has ended
  std::jthread thread_;         ///< last: joined before what it uses is destroyed
};

}  // namespace wobblebench::bench
