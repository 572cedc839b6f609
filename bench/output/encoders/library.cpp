// The library that bench/output/encoders.cpp loads: pictures by OpenImageIO, videos by OpenCV.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "bench/output/encoders.h"

namespace wobblebench::bench {

namespace {

std::vector<char> encode_image(const Raster& raster, const std::string& extension) {
  OIIO::ImageSpec spec(raster.width,
                       raster.height,
                       static_cast<int>(raster.channels.size()),
                       raster.bytes ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
  spec.channelnames = raster.channels;
  for (const auto& [name, value] : raster.attributes) spec.attribute(name, value);
  for (const auto& [name, number] : raster.numbers) spec.attribute(name, number);
  for (const auto& [name, matrix] : raster.matrices) {
    spec.attribute(name, OIIO::TypeMatrix, matrix.data());
  }
  // In memory: OpenImageIO does not check the last flush of its own files.
  OIIO::Filesystem::IOVecOutput encoded;
  const std::string name = "picture" + extension;
  const auto output = OIIO::ImageOutput::create(name, &encoded);
  if (!output) throw std::runtime_error(OIIO::geterror());
  const bool whole = output->open(name, spec) &&
                     output->write_image(OIIO::TypeDesc::FLOAT, raster.values.data()) &&
                     output->close();
  if (!whole) throw std::runtime_error(output->geterror());
  const auto& bytes = encoded.buffer();
  return {bytes.begin(), bytes.end()};
}

std::string compress(const std::string& png, int most_side) {
  OIIO::Filesystem::IOMemReader bytes(OIIO::string_view(png).data(), png.size());
  OIIO::ImageBuf picture("picture.png", 0, 0, nullptr, nullptr, &bytes);
  if (!picture.read(0, 0, true, OIIO::TypeDesc::UINT8)) {
    throw std::runtime_error(picture.geterror());
  }
  const OIIO::ImageSpec given = picture.spec();  // a copy: `picture` is replaced below
  const double scale = std::min(1.0, 1.0 * most_side / std::max(given.width, given.height));
  const auto scaled = [&](int side) {
    return std::max(1, static_cast<int>(std::lround(scale * side)));
  };
  const OIIO::ROI size(0, scaled(given.width), 0, scaled(given.height), 0, 1, 0, given.nchannels);
  if (scale < 1) picture = OIIO::ImageBufAlgo::resize(picture, "", 0, size);
  Raster raster{
      .width = size.width(),
      .height = size.height(),
      .channels = given.channelnames,
      .bytes = true,
      .values = std::vector<float>(size.npixels() * static_cast<std::size_t>(size.nchannels())),
      .attributes = {{"Compression", "jpeg:92"}, {"jpeg:subsampling", "4:4:4"}}};
  picture.get_pixels(size, OIIO::TypeDesc::FLOAT, raster.values.data());
  const std::vector<char> jpeg = encode_image(raster, ".jpg");
  return {jpeg.begin(), jpeg.end()};
}

/// OpenImageIO's message as one line.
std::invalid_argument unreadable(const std::string& reason) {
  const std::string line = reason.substr(0, reason.find('\n'));
  return std::invalid_argument("is no readable picture (" + line + ")");
}

void check_window(int width, int height, const OIIO::ImageSpec& spec, int most_side) {
  if (width >= 1 && height >= 1 && std::max(width, height) <= most_side && spec.depth == 1 &&
      spec.nchannels <= 64) {
    return;
  }
  throw std::invalid_argument("has " + std::to_string(width) + " x " + std::to_string(height) +
                              " pixels; at most " + std::to_string(most_side) + " a side are read");
}

/// A file may claim any size: of what codecs of pictures make, with room.
void check_claim(const OIIO::ImageSpec& spec, const std::filesystem::path& path) {
  constexpr double kMostRatio = 10'000;
  const auto there = static_cast<double>(std::filesystem::file_size(path));
  if (static_cast<double>(spec.image_bytes(true)) <= kMostRatio * there) return;
  throw std::invalid_argument("claims " + std::to_string(spec.image_bytes(true)) +
                              " bytes of picture; has too few for them");
}

/// A file may store a part of its picture (OpenEXR's data window in the display window): NaN where
/// there is none. What lies outside of the picture is left out.
void place_in_window(const OIIO::ImageSpec& spec, DecodedPicture& picture) {
  const bool whole = spec.x == spec.full_x && spec.y == spec.full_y &&
                     spec.width == spec.full_width && spec.height == spec.full_height;
  if (whole) return;
  DecodedPicture part = std::move(picture);
  picture = part;
  picture.width = spec.full_width;
  picture.height = spec.full_height;
  const auto channels = static_cast<std::ptrdiff_t>(picture.channels.size());
  picture.values.assign(static_cast<std::size_t>(channels) * spec.full_width * spec.full_height,
                        NAN);
  const int left = spec.x - spec.full_x, top = spec.y - spec.full_y;
  const int from = std::max(0, left), to = std::min(spec.full_width, left + spec.width);
  for (int row = std::max(0, top); row < std::min(spec.full_height, top + spec.height); ++row) {
    if (from >= to) break;
    const auto stored =
        part.values.begin() + channels * ((row - top) * std::ptrdiff_t{spec.width} + from - left);
    std::copy_n(stored,
                channels * (to - from),
                picture.values.begin() + channels * (row * std::ptrdiff_t{spec.full_width} + from));
  }
}

template <class Stored>
void read_values(OIIO::ImageInput& input, OIIO::TypeDesc type, DecodedPicture& picture) {
  std::vector<Stored> stored(static_cast<std::size_t>(picture.width) *
                             static_cast<std::size_t>(picture.height) * picture.channels.size());
  const bool is_read = input.read_image(0, 0, 0, -1, type, stored.data());
  // Of a TIFF file that is cut it reads what is there, says so, and calls that a success.
  if (!is_read || input.has_error()) throw unreadable(input.geterror());
  picture.values.assign(stored.begin(), stored.end());
}

/// In the type in which they are stored: OpenImageIO scales integers to the range of another type.
void read_stored_values(OIIO::ImageInput& input, DecodedPicture& picture) {
  const OIIO::TypeDesc type = input.spec().format;
  switch (type.basetype) {
    case OIIO::TypeDesc::UINT8:
      return read_values<std::uint8_t>(input, type, picture);
    case OIIO::TypeDesc::INT8:
      return read_values<std::int8_t>(input, type, picture);
    case OIIO::TypeDesc::UINT16:
      return read_values<std::uint16_t>(input, type, picture);
    case OIIO::TypeDesc::INT16:
      return read_values<std::int16_t>(input, type, picture);
    case OIIO::TypeDesc::UINT32:
      return read_values<std::uint32_t>(input, type, picture);
    case OIIO::TypeDesc::INT32:
      return read_values<std::int32_t>(input, type, picture);
    case OIIO::TypeDesc::HALF:
    case OIIO::TypeDesc::FLOAT:
    case OIIO::TypeDesc::DOUBLE:
      return read_values<double>(input, OIIO::TypeDesc::DOUBLE, picture);
    default:
      throw unreadable("it has values of type " + std::string(type.c_str()));
  }
}

void add_attributes(const OIIO::ImageSpec& spec, DecodedPicture& picture) {
  for (const auto& attribute : spec.extra_attribs) {
    const std::string name = attribute.name().string();
    if (attribute.type() == OIIO::TypeString) {
      picture.texts.emplace_back(name, attribute.get_string());
    } else if (attribute.type() == OIIO::TypeMatrix) {
      const auto* first = static_cast<const float*>(attribute.data());
      std::copy_n(
          first, 16, picture.matrices.emplace_back(name, std::array<float, 16>{}).second.data());
    }
  }
}

DecodedPicture decode_image(const std::filesystem::path& path, int most_side) {
  const auto input = OIIO::ImageInput::open(path.string());
  if (!input) throw unreadable(OIIO::geterror());
  const OIIO::ImageSpec& spec = input->spec();
  check_window(spec.width, spec.height, spec, most_side);
  check_window(spec.full_width, spec.full_height, spec, most_side);
  check_claim(spec, path);
  DecodedPicture picture{
      spec.width, spec.height, spec.channelnames, !spec.format.is_floating_point(), {}, {}, {}};
  read_stored_values(*input, picture);
  place_in_window(spec, picture);
  add_attributes(spec, picture);
  return picture;
}

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

std::unique_ptr<VideoEncoder> open_video(const std::filesystem::path& path,
                                         const VideoFormat& format) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  auto encoder = std::make_unique<OpenCvEncoder>();
  // FFmpeg first: some pictures of OpenCV's own Motion JPEG lack their last bytes, which readers
  // complain about.
  const bool opened = encoder->open(path, cv::CAP_FFMPEG, format) ||
                      (format.or_by_opencv && encoder->open(path, cv::CAP_OPENCV_MJPEG, format));
  if (!opened) return nullptr;
  return encoder;
}

}  // namespace

}  // namespace wobblebench::bench

extern "C" const wobblebench::bench::Encoders* wobblebench_encoders() {
  using namespace wobblebench::bench;
  static constexpr Encoders encoders{encode_image, compress, decode_image, open_video};
  return &encoders;
}
