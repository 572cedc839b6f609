// What becomes of the pictures of a stream: a video, the last picture, depths to be measured.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "bench/output/video.h"
#include "bench/pipeline/stream/kept_depths.h"
#include "bench/pipeline/stream/shown_picture.h"
#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

/// take() is called on the stream's writing thread, the rest before and after the stream.
class StreamSink {
 public:
  /// `video`: null: none. `most_depths`: 0: none are kept.
  StreamSink(const hw::AcquisitionPlan& plan, std::unique_ptr<Video> video, int most_depths);

  void take(const ShownPicture& shown);

  /// Shows the last picture for the time of one volume. Null: there is no video, or no picture.
  const Video* finish_video();
  /// Of a whole volume.
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
