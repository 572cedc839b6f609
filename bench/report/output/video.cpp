#include "bench/report/output/video.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "base/user_error.h"
#include "bench/report/output/image_io.h"

namespace wobblebench::bench {

namespace {

int four_letters(Codec codec) {
  using cv::VideoWriter;
  switch (codec) {
    case Codec::mjpg:
      return VideoWriter::fourcc('M', 'J', 'P', 'G');
    case Codec::mp4v:
      return VideoWriter::fourcc('m', 'p', '4', 'v');
    case Codec::avc1:
      return VideoWriter::fourcc('a', 'v', 'c', '1');
  }
  throw std::logic_error("codec");
}

uchar display_byte(float light) {
  return cv::saturate_cast<uchar>(255.0f * encoded(std::clamp(light, 0.0f, 1.0f)));
}

}  // namespace

struct Video::Impl {
  cv::VideoWriter writer;
  cv::Mat picture;  ///< the last one, 8-bit BGR; empty: none yet
  std::filesystem::path path;
  std::string backend;
  long frames = 0;

  /// Repeats the last picture until its video frame at `time_s` is due.
  void show_until(double time_s) {
    const auto due = std::lround(time_s * kVideoFramesPerSecond);
    if (picture.empty()) return;
    for (; frames < due; ++frames) writer.write(picture);
  }
};

Video::Video(const std::filesystem::path& path, Codec codec, int width, int height)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  const cv::Size size(width, height);
  const auto open = [&](int backend) {
    return impl_->writer.open(
        path.string(), backend, four_letters(codec), kVideoFramesPerSecond, size);
  };
  // Of OpenCV's own Motion JPEG some pictures lack their last bytes, which readers remark on.
  const bool opened = open(cv::CAP_FFMPEG) || (codec == Codec::mjpg && open(cv::CAP_OPENCV_MJPEG));
  if (!opened) {
    throw UserError("--codec = " + std::string(to_string(codec)) + ": OpenCV cannot write " +
                    std::to_string(width) + " x " + std::to_string(height) +
                    " pictures with it here; mjpg needs nothing else, "
                    "none writes no video");
  }
  impl_->backend = impl_->writer.getBackendName();
}

Video::~Video() = default;

void Video::add(const Image<glm::vec3>& light, double time_s) {
  impl_->show_until(time_s);
  cv::Mat picture(light.height, light.width, CV_8UC3);
  std::transform(light.pixels.begin(),
                 light.pixels.end(),
                 picture.begin<cv::Vec3b>(),
                 [](const glm::vec3& rgb) {
                   return cv::Vec3b(display_byte(rgb.b), display_byte(rgb.g), display_byte(rgb.r));
                 });
  impl_->picture = picture;
}

void Video::finish(double time_s) {
  // At least one frame of the last picture.
  impl_->show_until(std::max(time_s, seconds() + 1 / kVideoFramesPerSecond));
  impl_->writer.release();
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
