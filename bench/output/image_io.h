// Files of pictures (PNG) and maps (EXR), by OpenImageIO.
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/image.h"
#include "render/camera.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// What the values of a picture, in [0, 1], are: colours as sRGB (IEC 61966-2-1) encodes them, or
/// light, which is encoded so.
enum class Values { display, light };

/// sRGB's transfer function (IEC 61966-2-1).
float encoded(float light);
Image<glm::vec3> encoded(Image<glm::vec3> light);

/// Bytes of an 8-bit RGB PNG in sRGB, which the file says. May be called from several threads.
/// Throws std::runtime_error.
std::vector<char> png(const Image<glm::vec3>& image, Values values = Values::display);
/// The same as a new file, as write_new_file(). Throws std::runtime_error "PATH: reason".
void write_png(const std::filesystem::path& path,
               const Image<glm::vec3>& image,
               Values values = Values::display);

/// As it is stored, in [0, 1]; empty where there is no such file. Throws std::runtime_error where
/// it is no picture in colours of whole numbers.
Image<glm::vec3> read_png(const std::filesystem::path& path);

/// A channel of an EXR: lengths in metres, which are written in millimetres, or plain numbers.
struct NamedMap {
  std::string name;
  const Image<float>* map;
  float scale = 1000.0f;  ///< 1: plain numbers
};
/// Bytes of a float EXR with one named channel a map, linear; pixels without a value are NaN. The
/// header holds the camera's matrices, mm per pixel and projection. May be called from several
/// threads. Throws std::runtime_error.
std::vector<char> exr_mm(const std::vector<NamedMap>& maps_m, const render::Camera& camera);
/// depth.exr: Z, Z_filtered and, where all of z was not found, drawn.
std::vector<char> depth_exr(const render::Picture& picture, const render::Camera& camera);

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
  /// Name of the encoder that OpenCV uses.
  const std::string& backend() const;

 private:
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::bench
