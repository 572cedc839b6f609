// The renderer of the live page: settings may change between its frames.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/live/panel.h"
#include "bench/pipeline/stream/stream.h"
#include "hw/probe/polar_volume.h"
#include "render/gl/context.h"
#include "render/renderer.h"

namespace wobblebench::bench {

using SharedFrames = std::shared_ptr<const std::vector<hw::PolarFrame>>;

/// A picture on its way to the viewers.
struct LivePicture {
  render::Picture picture;
  std::shared_ptr<const LiveState> state;  ///< it was made by
  std::uint32_t volume = 0;                ///< last that was whole when it was made
  SharedFrames frames;                     ///< of that volume; null: none was whole yet
  int lost_sticks = 0;                     ///< of that volume
  double render_ms = 0;                    ///< passes 2 to 4
  bool is_coarse = false;                  ///< half the pixels a side; the one of all follows
};
using SharedPicture = std::shared_ptr<const LivePicture>;

/// Renders by the panel's newest state: a change makes a picture of the last whole volume at once,
/// between frames and while none comes; where new rays take longer than `patience_ms`, first a
/// coarse one. Used by the thread that owns the context.
class LiveRenderer : public StreamRenderer {
 public:
  /// All must outlive it. The panel has a state. `show` gets each picture.
  /// `show_compared` gets the picture and, of the same volume, that of the settings at the start.
  LiveRenderer(render::GlContext& context,
               LivePanel& panel,
               std::function<void(SharedPicture)> show,
               std::function<void(const LivePicture&, const render::Picture&)> show_compared,
               double patience_ms = 75);

  void begin_volume(std::uint32_t volume) override;
  double add_frame(int frame, const hw::PolarFrame& samples) override;
  render::Picture render() override;
  void idle() override { follow(); }

  /// A new stream of the same scan begins: the part of a volume that is here will not be ended.
  void begin_stream();
  /// The last whole volume; nullopt: none was.
  std::optional<std::uint32_t> last_volume() const { return last_volume_; }

 private:
  bool follow();
  void compare();
  void take(const std::shared_ptr<const LiveState>& state);
  void rebuild(const std::shared_ptr<const LiveState>& state);
  render::Picture make_picture();
  bool show_coarse();
  LivePicture rendered();

  render::GlContext& context_;
  LivePanel& panel_;
  const std::function<void(SharedPicture)> show_;
  const std::function<void(const LivePicture&, const render::Picture&)> show_compared_;
  const double patience_ms_;
  double cast_ms_ = 0;  ///< the last picture with new rays took
  std::shared_ptr<const LiveState> state_;
  std::unique_ptr<render::Renderer> renderer_;
  std::vector<hw::PolarFrame> current_;  ///< of the volume under way; without samples: not here
  std::uint32_t volume_ = 0;             ///< under way
  SharedFrames whole_;
  SharedPicture shown_;         ///< the newest
  std::uint64_t compared_ = 0;  ///< LivePanel::comparisons() that were answered
  std::optional<std::uint32_t> last_volume_;
};

}  // namespace wobblebench::bench
