// Sends what a stream shows by OpenIGTLink while it runs (docs/exchange.md).
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "bench/exchange/export/exported_scan.h"
#include "bench/exchange/export/sample_grid.h"
#include "bench/exchange/igtl/message.h"
#include "bench/exchange/igtl/message_server.h"
#include "bench/pipeline/send/send_arguments.h"
#include "bench/pipeline/stream/stream_queues.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// Of one kind of message.
struct SentKind {
  std::uint64_t made = 0;
  std::uint64_t superseded = 0;  ///< not made: a later one was to be made before its turn came
};

struct SendReport {
  std::string address;
  SendArguments arguments;
  std::map<std::string, SentKind> kinds;  ///< by device name
  IgtlServerReport server;
};

/// Messages are made on a thread of its own, and only while a client is connected; of frames and
/// pictures that come faster the newest are taken, so that the stream never waits.
class StreamSender {
 public:
  /// Listens from now on. Throws UserError "--send = ARGS: …".
  explicit StreamSender(const SendArguments& arguments);
  ~StreamSender();
  StreamSender(const StreamSender&) = delete;
  StreamSender& operator=(const StreamSender&) = delete;

  const std::string& address() const { return server_.address(); }
  /// Before the first frame. `scan` must outlive this. Waits for the clients that it is to wait
  /// for. Throws UserError.
  void begin(const ExportedScan& scan);
  /// On the thread that renders: a frame as it arrived, in the order of their arrival.
  void add_frame(const StreamFrame& frame);
  /// From any one thread.
  void take(const ShownPicture& shown);
  /// Sends the status `text`, lets clients take what waits, and closes.
  SendReport finish(const std::string& text);

 private:
  struct VolumeJob {
    hw::PolarVolume volume;
    int frames = 0;  ///< that were added
    int lost = 0;
    StickTimes first, last;
  };

  void work();
  template <class Job>
  void post(std::optional<Job>& place, Job job, const char* device);
  /// `part`: of several of one device that do not replace each other.
  void send(const std::string& device, std::string message, int part = 0);
  void send_pose(const StreamFrame& frame);
  void collect(const StreamFrame& frame);
  void send_picture(const ShownPicture& shown);
  void send_surface(const ShownPicture& shown);
  void send_volume(const VolumeJob& job);
  void send_polar(const VolumeJob& job);
  void send_samples(const IgtlHead& head, IgtlImage image, std::span<const float> samples);
  IgtlHead head(const char* device,
                std::uint32_t volume,
                const StickTimes& first,
                const StickTimes& last,
                int lost) const;
  IgtlHead volume_head(const char* device, const char* content, const VolumeJob& job) const;
  glm::dvec3 on_axes(const glm::dvec3& v) const;

  const SendArguments arguments_;
  IgtlServer server_;
  const ExportedScan* scan_ = nullptr;
  std::optional<SampleGrid> grid_;
  std::optional<VolumeJob> collected_;  ///< of the volume under way

  std::mutex mutex_;  ///< of what follows
  std::condition_variable changed_;
  std::optional<ShownPicture> picture_;
  std::optional<VolumeJob> volume_;
  std::map<std::string, SentKind> kinds_;
  bool ends_ = false;
  std::jthread thread_;
};

}  // namespace wobblebench::bench
