// Pictures on disk, and how alike two are.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include "base/file.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/output/encoders.h"
#include "bench/output/image_io.h"
#include "tests/support/expect.h"
#include "tests/support/file_limit.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

using testing_support::ScratchFolder;

Image<glm::vec3> ramp(int size) {
  Image<glm::vec3> image(size, size);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      image.at(column, row) = glm::vec3(static_cast<float>(column) / static_cast<float>(size));
    }
  }
  return image;
}

/// A picture of one colour, and a wide one at that, comes back scaled and with its colour.
TEST(Encoders, CompressScalesWhatIsLargerThanItMayBe) {
  const auto compressed = [](int width, int height) {
    Raster raster{.width = width,
                  .height = height,
                  .channels = {"R", "G", "B"},
                  .bytes = true,
                  .values = {},
                  .attributes = {}};
    for (int i = 0; i < width * height; ++i) {
      raster.values.insert(raster.values.end(), {1.0F, 0.5F, 0.25F});
    }
    const std::vector<char> png = encoders().encode(raster, ".png");
    return encoders().compress({png.begin(), png.end()}, 1024);
  };
  for (const auto& [width, height, scaled_width, scaled_height] :
       {std::array{1500, 500, 1024, 341}, {300, 2048, 150, 1024}, {1024, 3, 1024, 3}}) {
    const std::string jpeg = compressed(width, height);
    const ScratchFolder folder;
    const auto path = folder.path() / "compressed.jpg";
    write_new_file(path, {jpeg.data(), jpeg.size()});
    const auto read = OIIO::ImageInput::open(path.string());
    ASSERT_TRUE(read);
    EXPECT_EQ(read->spec().width, scaled_width);
    EXPECT_EQ(read->spec().height, scaled_height);
    std::vector<float> pixels(static_cast<std::size_t>(3 * scaled_width * scaled_height));
    ASSERT_TRUE(read->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, pixels.data()));
    EXPECT_NEAR(pixels[0], 1, 0.03);
    EXPECT_NEAR(pixels[1], 0.5, 0.03);
    EXPECT_NEAR(pixels[2], 0.25, 0.03);
  }
}

void write_exr(const std::filesystem::path& path, const std::vector<NamedMap>& maps) {
  const std::vector<char> bytes = exr_mm(maps, render::make_camera({}));
  write_new_file(path, {bytes.data(), bytes.size()});
}

TEST(ImageIo, PngKeepsRowsColumnsAndChannels) {
  Image<glm::vec3> image(7, 5);
  image.at(6, 0) = {1, 0, 0};
  image.at(0, 4) = {0, 0.5f, 1};
  const ScratchFolder folder;
  const auto path = folder.path() / "pixels.png";
  write_png(path, image);
  const auto input = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(input);
  std::vector<unsigned char> values(7 * 5 * 3);
  ASSERT_EQ(input->spec().width, 7);
  ASSERT_EQ(input->spec().height, 5);
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, values.data()));
  EXPECT_EQ(values[6 * 3], 255);
  EXPECT_EQ(values[(4 * 7) * 3 + 1], 128);
  EXPECT_EQ(values[(4 * 7) * 3 + 2], 255);
}

/// Values by IEC 61966-2-1: 255 (1.055 x^(1/2.4) - 0.055), below 0.0031308 255 x 12.92.
TEST(ImageIo, LightIsEncodedInSrgbAndTheFileSaysSo) {
  Image<glm::vec3> image(2, 1);
  image.at(0, 0) = {0, 0.002f, 0.0214f};
  image.at(1, 0) = {0.2f, 0.5f, 1};
  const ScratchFolder folder;
  const auto path = folder.path() / "light.png";
  for (const auto& [meaning, expected] :
       {std::pair{Values::light, std::vector<unsigned char>{0, 7, 40, 124, 188, 255}},
        std::pair{Values::display, std::vector<unsigned char>{0, 1, 5, 51, 128, 255}}}) {
    std::filesystem::remove(path);
    write_png(path, image, meaning);
    const auto input = OIIO::ImageInput::open(path.string());
    ASSERT_TRUE(input);
    EXPECT_EQ(input->spec().get_string_attribute("oiio:ColorSpace"), "sRGB");
    std::vector<unsigned char> values(6);
    ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, values.data()));
    EXPECT_EQ(values, expected);
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    EXPECT_TRUE(holds(bytes.str(), "sRGB")) << "the chunk, not a reader's guess";
  }
}

TEST(ImageIo, ExrHoldsMillimetresInNamedChannelsAndNanForNone) {
  Image<float> depth(3, 2, 0.0625f), other(3, 2, 0.5f);
  depth.at(2, 1) = kNoSurface;
  const ScratchFolder folder;
  const auto path = folder.path() / "maps.exr";
  write_exr(path, {{"Z", &depth}, {"Z_filtered", &other}});
  const auto input = OIIO::ImageInput::open(path.string());
  ASSERT_TRUE(input);
  ASSERT_EQ(input->spec().nchannels, 2);
  std::vector<float> values(3 * 2 * 2);
  ASSERT_TRUE(input->read_image(0, 0, 0, 2, OIIO::TypeDesc::FLOAT, values.data()));
  const auto z = static_cast<std::size_t>(input->spec().channelindex("Z"));
  EXPECT_EQ(values[z], 62.5f);
  EXPECT_EQ(values[1 - z], 500.0f);
  EXPECT_TRUE(std::isnan(values[(1 * 3 + 2) * 2 + z]));
}

TEST(ImageIo, WhatCannotBeWrittenIsNamed) {
  const std::string refusal =
      refusal_of<std::runtime_error>([&] { write_png("/proc/no/such.png", ramp(4)); });
  EXPECT_TRUE(refusal.starts_with("/proc/no/such.png: ")) << refusal;
}

/// Writes with the disk full some bytes before the end, at several positions in the buffers.
template <class Write>
void expect_full_disk_is_said(const std::filesystem::path& path, const Write& write) {
  write(path);
  const auto size = std::filesystem::file_size(path);
  EXPECT_THROW(write(path), std::runtime_error) << "there is a file of that name";
  std::filesystem::remove(path);
  for (const std::uintmax_t missing : {std::uintmax_t{1}, std::uintmax_t{100}, size / 2, size}) {
    const testing_support::FileLimit limit(size - missing);
    EXPECT_THROW(write(path), std::runtime_error) << missing << " of " << size << " bytes missing";
  }
  EXPECT_NO_THROW(write(path));
  EXPECT_EQ(std::filesystem::file_size(path), size);
  std::filesystem::remove(path);
}

TEST(ImageIo, AFullDiskIsSaidHoweverLate) {
  const ScratchFolder scratch;
  for (const int size : {4, 64, 200}) {
    expect_full_disk_is_said(scratch.path() / "a.png",
                             [&](const auto& path) { write_png(path, ramp(size)); });
    const Image<float> depth(size, size, 0.1f);
    expect_full_disk_is_said(scratch.path() / "a.exr", [&](const auto& path) {
      write_exr(path, {{"Z", &depth}});
    });
  }
}

TEST(ImageSimilarity, OfEqualPicturesIsPerfect) {
  const auto same = compare_images(ramp(32), ramp(32));
  EXPECT_NEAR(same.ssim, 1, 1e-12);
  EXPECT_TRUE(std::isinf(same.psnr_db));
}

TEST(ImageSimilarity, OfAConstantOffsetFollowsItsFormulas) {
  Image<glm::vec3> a(24, 24, glm::vec3(0.4f)), b(24, 24, glm::vec3(0.6f));
  const auto result = compare_images(a, b);
  EXPECT_NEAR(result.psnr_db, -20 * std::log10(0.2), 1e-5);
  // No structure: the luminance term alone, (2 mx my + C1) / (mx^2 + my^2 + C1).
  EXPECT_NEAR(result.ssim, (2 * 0.24 + 1e-4) / (0.16 + 0.36 + 1e-4), 1e-6);
}

TEST(ImageSimilarity, RefusesDifferentSizes) {
  EXPECT_THROW(compare_images(ramp(32), ramp(33)), std::invalid_argument);
  EXPECT_THROW(compare_images(ramp(8), ramp(8)), std::invalid_argument);
}

}  // namespace
}  // namespace wobblebench::bench
