#include "bench/output/encoders/video_encoder.h"

#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>

namespace wobblebench::bench {

namespace {

class OpenCvEncoder : public VideoEncoder {
 public:
  bool open(const std::filesystem::path& path, int backend, const VideoFormat& format) {
    const auto& letters = format.four_letters;
    size_ = {format.width, format.height};
    return writer_.open(path.string(),
                        backend,
                        cv::VideoWriter::fourcc(letters[0], letters[1], letters[2], letters[3]),
                        format.frames_per_second,
                        size_);
  }

  void add(const std::vector<std::uint8_t>& bgr) override {
    cv::Mat picture(size_, CV_8UC3);
    std::copy(bgr.begin(), bgr.end(), picture.data);
    writer_.write(picture);
  }

  std::string backend() const override { return writer_.getBackendName(); }

 private:
  cv::Size size_;
  cv::VideoWriter writer_;
};

}  // namespace

std::unique_ptr<VideoEncoder> open_video(const std::filesystem::path& path,
                                         const VideoFormat& format) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  auto encoder = std::make_unique<OpenCvEncoder>();
  // Of OpenCV's own Motion JPEG some pictures lack their last bytes, which readers remark on.
  const bool opened = encoder->open(path, cv::CAP_FFMPEG, format) ||
                      (format.or_by_opencv && encoder->open(path, cv::CAP_OPENCV_MJPEG, format));
  if (!opened) return nullptr;
  return encoder;
}

}  // namespace wobblebench::bench
