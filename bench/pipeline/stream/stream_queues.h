// What travels between the threads of a stream, and the queues that hold it: frames from the board
// to the renderer, pictures from there to the sink.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

#include "base/options.h"
#include "hw/probe/clock.h"
#include "hw/probe/polar_volume.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// The host's clock throughout. `fired`: scheduled, by the link's epoch; unset where the device has
/// a clock of its own.
struct StickTimes {
  std::optional<hw::HostTime> fired;
  hw::HostTime received;  ///< by the board, which the device notified (StickSlot::received())
  hw::HostTime acquired;  ///< taken from the board
  hw::HostTime placed;    ///< copied into its frame
  hw::DeviceTime device;  ///< of firing, as the stick says: the device's clock
  bool arrived = true;    ///< false: all times but `fired` are those of the nearest that did
};

/// A frame, with the times of its sticks.
struct StreamFrame {
  std::uint32_t volume = 0;
  int frame = 0;
  hw::PolarFrame samples;
  int sticks = 0;  ///< that arrived
  /// Of the first and the last line. Where no line arrived, their times are when that was known.
  StickTimes first, last;
  hw::HostTime complete;     ///< its last line was placed, or was known not to come
  bool ends_volume = false;  ///< the last that the volume will get
};

/// Times of the echoes in a picture, and of what was done with them. The host's clock throughout.
struct PictureTimes {
  std::uint32_t volume = 0;  ///< of the newest frame
  bool whole = true;         ///< shows one volume; mid-volume pictures show two
  int sticks = 0;            ///< of that volume, so far
  int lost = 0;              ///< sticks that it lacks of the frames so far
  StickTimes first, last;    ///< of that volume: its first stick, and the newest in the picture
  hw::HostTime begun;        ///< pass 1 of the volume's first frame begins
  double update_ms = 0;      ///< pass 1 of the frames since the last picture
  double waited_ms = 0;      ///< since the last picture, for frames
  hw::HostTime complete;     ///< the newest frame was
  hw::HostTime taken;        ///< the newest frame, from the queue
  double pass_1_ms = 0;      ///< of the newest frame
  hw::HostTime uploaded;     ///< pass 1 of the newest frame is done; pass 2 begins
  std::vector<render::PassTime> passes;  ///< 2 to 4
  hw::HostTime ready;
  hw::HostTime written;  ///< the sink is done; ready where the picture was superseded
};

struct ShownPicture {
  PictureTimes times;
  render::Picture picture;
  int waiting_volumes = 0;       ///< in the queue of frames when the picture was ready
  std::uint64_t superseded = 0;  ///< volumes that the queue has dropped so far
};

/// What happens to volumes that come faster than they are rendered.
enum class StreamPolicy {
  newest,  ///< those that a later whole volume has overtaken are dropped: pictures stay fresh
  every,   ///< they wait, and then the board does: no volume is dropped here
};

constexpr std::string_view to_string(StreamPolicy policy) {
  return policy == StreamPolicy::newest ? "newest" : "every";
}

struct QueueOptions {
  StreamPolicy policy = StreamPolicy::newest;
  int volumes = 2;  ///< every: volumes that wait, the one under way included
};

template <OptionsOf<QueueOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("policy",
           o.policy,
           {{to_string(StreamPolicy::newest), StreamPolicy::newest},
            {to_string(StreamPolicy::every), StreamPolicy::every}});
  v.integer("queue", o.volumes, 1, 64);
}

/// Volumes and sticks of one fate.
struct VolumeCount {
  std::uint64_t volumes = 0;
  std::uint64_t sticks = 0;
};

struct QueueStatistics {
  VolumeCount superseded;         ///< dropped for a later volume
  std::uint64_t left_sticks = 0;  ///< here when it was stopped, or pushed later
  int most_volumes = 0;           ///< that waited at once
  double mean_volumes = 0;        ///< over the time since the first frame
  double blocked_ms = 0;          ///< that push() waited for room
};

/// Frames between the thread that acquires and the one that renders. Bounded, for one thread that
/// pushes and one that pops. A frame waits for room with `every` alone: with `newest` at most three
/// volumes are here, the one that is being rendered, a whole one and the one that is being
/// acquired. A volume whose first frame was popped is never dropped.
class VolumeQueue {
 public:
  /// Throws InvalidOption.
  explicit VolumeQueue(const QueueOptions& options);

  /// False once the queue was stopped: the frame is counted as left.
  bool push(StreamFrame frame);
  /// No more frames will come; those here can still be popped.
  void close();
  /// Wakes and refuses both threads.
  void stop();

  /// Waits until pop() would not, or for this time; false: pop() would still wait.
  bool wait_for(std::chrono::milliseconds time);
  /// The next frame, waiting for it. None: closed and empty, or stopped.
  std::optional<StreamFrame> pop();
  /// Whether pop() would wait.
  bool empty() const;
  /// Waiting volumes.
  int volumes() const;

  QueueStatistics statistics() const;

 private:
  struct Waiting {
    std::uint32_t volume;
    std::deque<StreamFrame> frames;
    std::uint64_t sticks = 0;  ///< of all its frames so far
    bool begun = false;        ///< a frame was popped
    bool whole = false;
  };

  bool is_ready() const;  ///< a frame can be popped; with the lock
  bool has_room(std::uint32_t volume) const;
  void drop_superseded();
  void count_occupancy();

  const QueueOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  bool closed_ = false, stopped_ = false;
  QueueStatistics statistics_;
  std::optional<hw::HostTime> first_, counted_;
  double volume_ms_ = 0;
};

/// Pictures between the thread that renders and the one that writes them. Holds one. With `every`
/// push() waits until it is taken; with `newest` a later picture replaces it. For one thread that
/// pushes and one that pops.
class PictureQueue {
 public:
  explicit PictureQueue(StreamPolicy policy) : policy_(policy) {}

  /// Returns the picture that will not be taken: the one that was replaced, if one was, or, once
  /// the queue is closed, `picture`.
  std::optional<ShownPicture> push(ShownPicture picture);
  /// No more pictures will come; the one here can still be popped.
  void close();
  /// The next picture, waiting for it. None: closed and empty.
  std::optional<ShownPicture> pop();

 private:
  const StreamPolicy policy_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<ShownPicture> waiting_;
  bool closed_ = false;
};

}  // namespace wobblebench::bench
