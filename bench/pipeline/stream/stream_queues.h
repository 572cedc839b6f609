// Frames between the thread that acquires and the one that renders.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string_view>

#include "base/options.h"
#include "bench/pipeline/stream/stream_frame.h"

namespace wobblebench::bench {

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
  int volumes = 2;  ///< every: so many volumes wait, the one under way included
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

/// Bounded, for one thread that pushes and one that pops. A frame waits for room with `every`
/// alone: with `newest` at most three volumes are here, the one that is being rendered, a whole one
/// and the one that is being acquired. A volume whose first frame was popped is never dropped.
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
  double volume_seconds_ = 0;
};

}  // namespace wobblebench::bench
