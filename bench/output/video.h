// Writing of videos, by OpenCV's VideoWriter.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "base/image.h"

namespace wobblebench::bench {

enum class Codec {
  mjpg,  ///< Motion JPEG in .avi, by FFmpeg or else by OpenCV itself
  mp4v,  ///< MPEG-4 Visual in .mp4, by FFmpeg
  avc1,  ///< H.264 in .mp4, by FFmpeg, where it was built with an encoder
};

constexpr std::string_view to_string(Codec codec) {
  return codec == Codec::mjpg ? "mjpg" : codec == Codec::mp4v ? "mp4v" : "avc1";
}
constexpr std::string_view extension(Codec codec) {
  return codec == Codec::mjpg ? ".avi" : ".mp4";
}

inline constexpr double kVideoFramesPerSecond = 10;

/// A video whose time is that of the pictures: each is shown until the next one's time.
class Video {
 public:
  /// Throws UserError "--codec = NAME: …" where OpenCV cannot write it here.
  Video(const std::filesystem::path& path, Codec codec, int width, int height);
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  /// `light`: linear RGB in [0, 1] of this video's size, from `time_s` after the first picture on.
  void add(const Image<glm::vec3>& light, double time_s);
  /// Shows the last picture until `time_s`, and completes the file. Throws std::runtime_error if it
  /// is empty.
  void finish(double time_s);

  double seconds() const;
  /// Of OpenCV: who encodes.
  const std::string& backend() const;

 private:
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::bench
