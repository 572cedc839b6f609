#include "bench/output/video.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "base/user_error.h"
#include "bench/output/encoders.h"
#include "bench/output/image_io.h"

namespace wobblebench::bench {

namespace {

VideoFormat format_of(Codec codec, int width, int height) {
  VideoFormat format{{'M', 'J', 'P', 'G'}, true, kVideoFramesPerSecond, width, height};
  if (codec == Codec::mjpg) return format;
  std::ranges::copy(to_string(codec), format.four_letters);
  format.or_by_opencv = false;
  return format;
}

std::uint8_t display_byte(float light) {
  return static_cast<std::uint8_t>(std::lrint(255.0f * encoded(std::clamp(light, 0.0f, 1.0f))));
}

}  // namespace

struct Video::Impl {
  std::unique_ptr<VideoEncoder> encoder;
  std::vector<std::uint8_t> picture;  ///< the last one, BGR; empty: none yet
  std::filesystem::path path;
  std::string backend;
  long frames = 0;

  /// Repeats the last picture until its video frame at `time_s` is due.
  void show_until(double time_s) {
    const auto due = std::lround(time_s * kVideoFramesPerSecond);
    if (picture.empty()) return;
    for (; frames < due; ++frames) encoder->add(picture);
  }
};

Video::Video(const std::filesystem::path& path, Codec codec, int width, int height)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  impl_->encoder = encoders().open_video(path, format_of(codec, width, height));
  if (impl_->encoder == nullptr) {
    throw UserError("--codec = " + std::string(to_string(codec)) + ": OpenCV cannot write " +
                    std::to_string(width) + " x " + std::to_string(height) +
                    " pictures with it here; mjpg needs nothing else, "
                    "none writes no video");
  }
  impl_->backend = impl_->encoder->backend();
}

Video::~Video() = default;

void Video::add(const Image<glm::vec3>& light, double time_s) {
  impl_->show_until(time_s);
  impl_->picture.clear();
  for (const glm::vec3& rgb : light.pixels) {
    impl_->picture.insert(impl_->picture.end(),
                          {display_byte(rgb.b), display_byte(rgb.g), display_byte(rgb.r)});
  }
}

void Video::finish(double time_s) {
  // At least one frame of the last picture.
  impl_->show_until(std::max(time_s, seconds() + 1 / kVideoFramesPerSecond));
  impl_->encoder.reset();
  std::error_code failed;
  const auto bytes = std::filesystem::file_size(impl_->path, failed);
  if (failed || bytes == 0)
    throw std::runtime_error(impl_->path.string() + ": nothing was written");
}

double Video::seconds() const {
  return static_cast<double>(impl_->frames) / kVideoFramesPerSecond;
}

const std::string& Video::backend() const {
  return impl_->backend;
}

}  // namespace wobblebench::bench
