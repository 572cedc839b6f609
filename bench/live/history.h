// The last minute of a live page's volumes, each with its newest picture as it was.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "bench/live/live_renderer.h"
#include "bench/live/server/live_server.h"

namespace wobblebench::bench {

/// How long, and of how much memory, volumes are kept; the oldest go first.
struct HistoryLimits {
  hw::HostClock::duration time = std::chrono::minutes(1);
  std::size_t bytes = std::size_t{320} << 20;
};

/// A frame with samples of 8 bits.
struct PackedFrame {
  std::vector<std::uint8_t> samples, arrived;
  std::vector<double> motor_angle_rad;
};

/// What is kept of a volume: enough for its picture, its error and its planes.
struct PastVolume {
  std::uint64_t number = 0;  ///< counts all that were kept, from 1
  hw::HostTime at;           ///< its picture was ready
  LiveMessage message;       ///< picture_message()
  std::shared_ptr<const LiveState> state;
  std::uint32_t volume = 0;
  Image<float> depth_m;
  Image<std::uint8_t> drawn;                               ///< render::Picture::drawn
  std::shared_ptr<const std::vector<PackedFrame>> frames;  ///< null: none was whole
  std::size_t bytes = 0;                                   ///< of memory

  /// The picture without its colours; its frames are rounded to steps of 1/255.
  LivePicture unpacked() const;
};

/// May be called from any thread.
class LiveHistory {
 public:
  explicit LiveHistory(const HistoryLimits& limits = {}) : limits_(limits) {}

  /// Takes the place of an earlier picture of this volume. `message`: its picture_message().
  void add(const LivePicture& shown, LiveMessage message);
  /// Volumes of another scan are not kept: their phantom may be gone.
  void clear();
  /// number, volume, seconds of device time, and the settings' serial of each, oldest first.
  nlohmann::ordered_json list() const;
  /// Null: it is no longer kept.
  std::shared_ptr<const PastVolume> find(std::uint64_t number) const;

 private:
  const HistoryLimits limits_;
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<const PastVolume>> volumes_;
  SharedFrames last_frames_;  ///< of the newest
  std::uint64_t added_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace wobblebench::bench
