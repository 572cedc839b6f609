// What `stream` keeps of its pictures: a video, the last picture, some depth images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/image.h"
#include "bench/output/image_io.h"
#include "bench/pipeline/stream/stream.h"
#include "hw/probe/acquisition_plan.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// The depth image of a volume.
struct KeptDepth {
  std::uint32_t volume = 0;
  Image<float> depth_m;
};

/// Depth images of some volumes of a stream, spread evenly over it, in bounded memory: those of
/// volumes 0, n, 2 n …; n doubles whenever there would be more than `most`.
class KeptDepths {
 public:
  /// `most`: 0: none are kept.
  explicit KeptDepths(int most) : most_(static_cast<std::size_t>(most)) {}

  void add(std::uint32_t volume, const Image<float>& depth_m) {
    if (most_ == 0 || volume % every_ != 0) return;
    kept_.push_back({volume, depth_m});
    while (kept_.size() > most_) {
      every_ *= 2;
      std::erase_if(kept_, [&](const KeptDepth& kept) { return kept.volume % every_ != 0; });
    }
  }
  const std::vector<KeptDepth>& kept() const { return kept_; }

 private:
  std::size_t most_;
  std::uint32_t every_ = 1;
  std::vector<KeptDepth> kept_;
};

/// take() is called on the stream's writing thread, the rest before and after the stream.
class StreamSink {
 public:
  /// `video`: null: none. `most_depths`: 0: none are kept.
  StreamSink(const hw::AcquisitionPlan& plan, std::unique_ptr<Video> video, int most_depths);

  void take(const ShownPicture& shown);

  /// Shows the last picture for the time of one volume. Null: there is no video, or no picture.
  const Video* finish_video();
  /// The last picture of a whole volume.
  const std::optional<render::Picture>& last_picture() const { return picture_; }
  const std::vector<KeptDepth>& depths() const { return depths_.kept(); }

 private:
  double time_s(const PictureTimes& times) const;

  const hw::AcquisitionPlan plan_;
  std::unique_ptr<Video> video_;
  KeptDepths depths_;
  std::optional<render::Picture> picture_;
  std::optional<std::uint32_t> first_;  ///< volume of the first picture
  std::uint32_t last_ = 0;
};

}  // namespace wobblebench::bench
