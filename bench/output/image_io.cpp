#include "bench/output/image_io.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "base/file.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/output/camera_matrices.h"
#include "bench/output/encoders.h"

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

std::array<float, 16> as_floats(const RowMatrix& matrix) {
  std::array<float, 16> floats{};
  std::ranges::transform(matrix, floats.begin(), [](double x) { return static_cast<float>(x); });
  return floats;
}

}  // namespace

float encoded(float light) {
  return light <= 0.0031308f ? 12.92f * light : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f;
}

Image<glm::vec3> encoded(Image<glm::vec3> light) {
  for (glm::vec3& pixel : light.pixels) {
    pixel = {encoded(pixel.r), encoded(pixel.g), encoded(pixel.b)};
  }
  return light;
}

std::vector<char> png(const Image<glm::vec3>& image, Values meaning) {
  // zlib's level 3 takes half the time of its usual 6, for files that are a tenth larger.
  Raster raster{image.width,
                image.height,
                {"R", "G", "B"},
                true,
                {},
                {{"oiio:ColorSpace", "sRGB"}, {"png:compressionLevel", "3"}}};
  raster.values.reserve(image.pixels.size() * 3);
  for (const glm::vec3& rgb : image.pixels) {
    raster.values.insert(raster.values.end(), {rgb.r, rgb.g, rgb.b});
  }
  if (meaning == Values::light) {
    for (float& value : raster.values) value = encoded(value);
  }
  return encoders().encode(raster, ".png");
}

Image<glm::vec3> read_png(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};
  constexpr int kMostSide = 16384;
  const DecodedPicture decoded = encoders().decode(path, kMostSide);
  const std::size_t channels = decoded.channels.size();
  if (channels < 3 || !decoded.integers)
    throw std::runtime_error(path.string() + ": is no picture");
  Image<glm::vec3> picture(decoded.width, decoded.height);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      picture.pixels[i][c] =
          static_cast<float>(decoded.values[i * channels + static_cast<std::size_t>(c)] / 255);
    }
  }
  return picture;
}

void write_png(const std::filesystem::path& path, const Image<glm::vec3>& image, Values meaning) {
  std::vector<char> bytes;
  try {
    bytes = png(image, meaning);
  } catch (const std::exception& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
  write_new_file(path, {bytes.data(), bytes.size()});
}

std::vector<char> exr_mm(const std::vector<NamedMap>& maps_m, const render::Camera& camera) {
  const Image<float>& first = *maps_m.at(0).map;
  const bool is_parallel = camera.projection == render::Projection::parallel;
  // The library writes the hour otherwise, and equal results would differ.
  Raster raster{first.width,
                first.height,
                {},
                false,
                {},
                {{"ImageDescription", "linear: lengths in millimetres; NaN: no value"},
                 {"DateTime", "0000:00:00 00:00:00"},
                 {"units", "mm"},
                 {"projection", is_parallel ? "parallel" : "perspective"},
                 {"world", kWorldFrame},
                 {"depth", depth_meaning(camera)},
                 {"pixels", kPixels}},
                {{"mmPerPixel", static_cast<float>(camera.pixel_m() / kMillimetre)}},
                {{"worldToCamera", as_floats(world_to_camera(camera))},
                 {"worldToNDC", as_floats(world_to_ndc(camera))}}};
  for (const NamedMap& named : maps_m) raster.channels.push_back(named.name);
  raster.values.reserve(first.pixels.size() * maps_m.size());
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    for (const NamedMap& named : maps_m) {
      raster.values.push_back(named.scale * named.map->pixels.at(i));
    }
  }
  return encoders().encode(raster, ".exr");
}

std::vector<char> depth_exr(const render::Picture& picture, const render::Camera& camera) {
  std::vector<NamedMap> maps = {{"Z", &picture.depth_m}, {"Z_filtered", &picture.filtered_depth_m}};
  const auto drawn = converted<float>(picture.drawn);
  if (!drawn.pixels.empty()) maps.push_back({"drawn", &drawn, 1});
  return exr_mm(maps, camera);
}

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
