#include "bench/cli/stream/stream_sink.h"

#include <algorithm>
#include <utility>

#include "base/duration.h"

namespace wobblebench::bench {

namespace {

/// So that a stream of hours makes no file that players refuse.
constexpr double kLongestVideo_s = 1200;

}  // namespace

StreamSink::StreamSink(const hw::AcquisitionPlan& plan,
                       std::unique_ptr<Video> video,
                       int most_depths)
    : plan_(plan), video_(std::move(video)), depths_(most_depths) {}

void StreamSink::take(const ShownPicture& shown) {
  const PictureTimes& times = shown.times;
  if (!first_) first_ = times.volume;
  if (video_ && time_s(times) < kLongestVideo_s) video_->add(shown.picture.surface, time_s(times));
  last_ = times.volume;
  if (!times.whole) return;
  depths_.add(times.volume, shown.picture.depth_m);
  picture_ = shown.picture;
}

const Video* StreamSink::finish_video() {
  if (!video_ || !first_) return nullptr;
  const double end_s = (last_ - *first_ + 1) * to_seconds(plan_.volume_duration());
  video_->finish(std::min(kLongestVideo_s, end_s));
  return video_.get();
}

/// On the device's clock, after the first picture's volume began: of a whole volume its first
/// stick, of a part of one its newest.
double StreamSink::time_s(const PictureTimes& times) const {
  const auto begin = plan_.stick_time(plan_.first_sequence(*first_));
  const int part = times.whole ? 0 : std::max(times.sticks + times.lost - 1, 0);
  const auto newest = plan_.first_sequence(times.volume) + static_cast<std::uint64_t>(part);
  return to_seconds(plan_.stick_time(newest) - begin);
}

}  // namespace wobblebench::bench
