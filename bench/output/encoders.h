// Encoders of picture and video files, in a library of their own: OpenImageIO and OpenCV's video
// bring some 240 shared libraries, which would delay every command by half a second and more.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wobblebench::bench {

/// A picture and what its file says of it.
struct Raster {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;
  bool bytes = false;         ///< 8 bits a value, of [0, 1]; else floats
  std::vector<float> values;  ///< interleaved channels
  std::vector<std::pair<std::string, std::string>> attributes;  ///< OpenImageIO's names
  std::vector<std::pair<std::string, float>> numbers = {};      ///< likewise
  std::vector<std::pair<std::string, std::array<float, 16>>> matrices = {};  ///< likewise
};

/// The numbers of a picture file, and what the file says of them.
struct DecodedPicture {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;
  bool integers = false;       ///< else floats
  std::vector<double> values;  ///< interleaved channels, integers as they are stored
  std::vector<std::pair<std::string, std::string>> texts;               ///< its attributes
  std::vector<std::pair<std::string, std::array<float, 16>>> matrices;  ///< likewise
};

/// An open video file. It is complete when this object is gone.
class VideoEncoder {
 public:
  virtual ~VideoEncoder() = default;
  /// One frame: 8-bit BGR, row by row.
  virtual void add(const std::vector<std::uint8_t>& bgr) = 0;
  /// Who encodes.
  virtual std::string backend() const = 0;
};

struct VideoFormat {
  char four_letters[4];
  bool or_by_opencv;  ///< where FFmpeg is missing: Motion JPEG alone
  double frames_per_second;
  int width;
  int height;
};

/// What the library offers.
struct Encoders {
  /// Bytes of a file of the format that `extension` names, ".png". Throws std::runtime_error.
  std::vector<char> (*encode)(const Raster& raster, const std::string& extension);
  /// A picture as JPEG of a quality without visible loss, at most `most_side` pixels wide and high.
  /// Throws std::runtime_error where the bytes are no picture.
  std::string (*compress)(const std::string& png, int most_side);
  /// A file in a format of OpenImageIO with at most `most_side` pixels a side. Throws
  /// std::invalid_argument with one line where it is none, is damaged or larger. NaN where the
  /// file stores no part of the picture.
  DecodedPicture (*decode)(const std::filesystem::path& path, int most_side);
  /// Null where OpenCV cannot write the format here.
  std::unique_ptr<VideoEncoder> (*open_video)(const std::filesystem::path& path,
                                              const VideoFormat& format);
};

/// Loads the library when first called: the one beside the program or installed with it, else the
/// one that was built. Throws std::runtime_error where that fails. May be called from several
/// threads.
const Encoders& encoders();

/// Loads them on a thread of its own while a command does something else: 0.2 s of linking. Where
/// that fails, encoders() says why.
[[nodiscard]] std::future<void> load_encoders_early();

}  // namespace wobblebench::bench
