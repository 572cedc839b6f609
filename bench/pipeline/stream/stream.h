// The stream: volume after volume from a board through the renderer to a sink, on three threads.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/stream/frame_reader.h"
#include "bench/pipeline/stream/stream_queues.h"
#include "bench/pipeline/stream/stream_source.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// Records kept of the last pictures, so that memory stays flat.
inline constexpr std::size_t kMostRecords = 100000;
/// Spans that each thread keeps for a trace, from the beginning on.
inline constexpr std::size_t kMostSpans = 20000;

/// Is shown each frame before pass 1 takes it, on the thread that runs the stream, which it holds
/// up.
using FrameTap = std::function<void(const StreamFrame&)>;

struct StreamOptions {
  QueueOptions queue;
  std::uint64_t volumes = 0;  ///< 0: to the end of the stream, or until it is stopped
  bool mid_volume = false;    ///< also a picture whenever no frame waits (PipelineOptions)
  bool keep_volume = false;   ///< StreamResult::kept
  FrameTap frames = {};       ///< unset: none
};

/// What one thread did from when to when. Of sticks the first and the last of each frame that
/// arrived.
struct StreamSpan {
  enum class Kind {
    stick_acquired,
    frame_acquired,
    frame_uploaded,
    picture_rendered,
    picture_written
  };
  Kind kind;
  std::uint32_t volume = 0;
  int frame = 0;  ///< of a picture: the newest
  hw::HostTime begin, end;
};

struct StreamResult {
  hw::HostTime begin, end;  ///< the board was started; the last thread ended
  hw::BoardAccount account;
  hw::WireDamage damage;
  hw::LinkCapabilities link;
  ReaderStatistics reader;
  QueueStatistics queue;
  VolumeCount shown;
  VolumeCount superseded_pictures;  ///< replaced before the sink took them
  std::uint64_t left_sticks = 0;    ///< of a picture that was rendered when the sink had ended
  std::uint64_t pictures = 0;       ///< rendered; mid-volume several a volume
  double renderer_busy_ms = 0, sink_busy_ms = 0;
  std::deque<PictureTimes> records;  ///< of the last kMostRecords pictures
  std::vector<StreamSpan> spans;     ///< in no order
  std::string failure;               ///< why the stream broke off; empty: it did not
  std::optional<KeptVolume> kept;    ///< the last volume, with StreamOptions::keep_volume
  /// Sticks that the reader took: each was shown, superseded or left.
  bool balanced() const {
    return reader.sticks == shown.sticks + queue.superseded.sticks + superseded_pictures.sticks +
                                left_sticks + queue.left_sticks + reader.left_sticks;
  }
};

/// What a stream needs of render::Renderer. Called on the thread that runs the stream.
class StreamRenderer {
 public:
  virtual ~StreamRenderer() = default;
  /// Before the first frame of a volume.
  virtual void begin_volume(std::uint32_t) {}
  /// While no frame waits, some 200 times a second: for a picture of what is there.
  virtual void idle() {}
  /// Uploads a frame; pass 1 of what that completes. Returns the wall time of pass 1, ms.
  virtual double add_frame(int frame, const hw::PolarFrame& samples) = 0;
  /// Passes 2 to 4.
  virtual render::Picture render() = 0;
};

/// Takes each picture, on a thread of its own, one at a time.
using PictureSink = std::function<void(const ShownPicture&)>;

/// Runs until the board's stream is over, `options.volumes` volumes have come, or `stopped` returns
/// true, which is asked every 20 ms. Rendering is done on the calling thread. A failure of the
/// board ends the stream, and is told in the result; UserError and failures of the sink and of the
/// renderer are thrown.
StreamResult run_stream(const StreamSource& source,
                        StreamRenderer& renderer,
                        const StreamOptions& options,
                        const PictureSink& sink,
                        const std::function<bool()>& stopped);

/// For a stream of which only the sticks are needed.
class NoRenderer : public StreamRenderer {
 public:
  double add_frame(int, const hw::PolarFrame&) override { return 0; }
  render::Picture render() override { return {}; }
};

/// Streams one volume, the first whose beginning was not missed. It is `kept` of the result; its
/// picture goes to `sink`. A volume that the end of the stream cut short is one, too, and so is one
/// without its first stick where no other follows: `reader.ending` says that the stream ended.
/// Throws NothingCame if no volume came, and what run_stream() throws.
StreamResult stream_one_volume(
    const StreamSource& source,
    StreamRenderer& renderer,
    const PictureSink& sink = [](const ShownPicture&) {});

}  // namespace wobblebench::bench
