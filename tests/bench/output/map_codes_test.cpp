// Maps of pages hold the values that EXR files hold.
#include "bench/output/picture/map_codes.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

namespace wobblebench::bench {
namespace {

/// RFC 4648, by its table.
std::string decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255);
  }
  return bytes;
}

std::string unpacked(const std::string& codes, std::size_t size) {
  const std::string packed = decoded(codes);
  std::string bytes(size, '\0');
  auto length = static_cast<uLongf>(size);
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(bytes.data()),
                       &length,
                       reinterpret_cast<const Bytef*>(packed.data()),
                       static_cast<uLong>(packed.size())),
            Z_OK);
  EXPECT_EQ(length, size);
  return bytes;
}

/// NaN: no value.
std::vector<double> values_mm(const MapLayer& layer, std::size_t count) {
  const std::string bytes = unpacked(layer.codes, 2 * count);
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const int code = static_cast<unsigned char>(bytes[2 * i]) +
                     256 * static_cast<unsigned char>(bytes[2 * i + 1]);
    values.push_back(code == 65535 ? std::nan("") : layer.first + layer.step * code);
  }
  return values;
}

TEST(MapCodes, HoldLengthsWithinHalfAStep) {
  Image<float> depth_m(37, 11, kNoSurface);
  for (std::size_t i = 0; i < depth_m.pixels.size(); i += 2) {
    depth_m.pixels[i] = 0.0712f + 1.37e-4f * static_cast<float>(i % 101);
  }
  const MapLayer layer = length_layer("found depth", depth_m);
  EXPECT_EQ(layer.step, 0.005);
  EXPECT_EQ(layer.unit, "mm");
  EXPECT_NEAR(layer.low, 71.2, 1e-4);
  EXPECT_NEAR(layer.high, 84.9, 1e-4);
  const auto values = values_mm(layer, depth_m.pixels.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % 2 == 1) {
      EXPECT_TRUE(std::isnan(values[i])) << i;
    } else {
      EXPECT_NEAR(values[i], 1e3 * static_cast<double>(depth_m.pixels[i]), 0.0025001) << i;
    }
  }
}

TEST(MapCodes, HoldLengthsThatSpanMoreThanTheFinestCodes) {
  Image<float> depth_m(2, 1);
  depth_m.pixels = {0.01f, 0.9f};
  const MapLayer layer = length_layer("depth", depth_m);
  const auto values = values_mm(layer, 2);
  EXPECT_NEAR(values[0], 10, 0.01);
  EXPECT_NEAR(values[1], 900, 0.01);
}

TEST(MapCodes, HoldTheLengthsBesideOnesThatAreNotFinite) {
  Image<float> depth_m(4, 1);
  depth_m.pixels = {0.01f, INFINITY, -INFINITY, 0.02f};
  const auto values = values_mm(length_layer("depth", depth_m), 4);
  EXPECT_NEAR(values[0], 10, 0.0025001);
  EXPECT_TRUE(std::isnan(values[1]) && std::isnan(values[2]));
  EXPECT_NEAR(values[3], 20, 0.0025001);
}

TEST(MapCodes, HoldSignedErrorsAroundAWhiteMiddle) {
  Image<float> error_m(3, 1);
  error_m.pixels = {-0.0123f, 0, 0.0021f};
  const MapLayer layer = error_layer("signed error", error_m, 3);
  EXPECT_EQ(layer.low, -3);
  EXPECT_EQ(layer.high, 3);
  EXPECT_EQ(layer.colours, MapLayer::Colours::diverging);
  const auto values = values_mm(layer, 3);
  EXPECT_NEAR(values[0], -12.3, 0.0025001);
  EXPECT_NEAR(values[1], 0, 0.0025001);
  EXPECT_NEAR(values[2], 2.1, 0.0025001);
}

TEST(MapCodes, OfAPictureWithoutAnySurfaceAreAllNone) {
  const MapLayer layer = length_layer("depth", Image<float>(4, 4, kNoSurface));
  EXPECT_LT(layer.low, layer.high);
  for (const double value : values_mm(layer, 16)) EXPECT_TRUE(std::isnan(value));
}

TEST(MapCodes, HoldClassesAsBytes) {
  Image<PixelClass> classes(3, 2);
  classes.at(2, 0) = PixelClass::missed;
  classes.at(0, 1) = PixelClass::outside_field;
  EXPECT_EQ(unpacked(class_codes(classes), 6), std::string("\0\0\1\5\0\0", 6));
}

TEST(MapCodes, ThinnedImagesKeepTheFirstOfEachBlock) {
  Image<float> image(5, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i);
  const auto few = thinned(image, 2);
  EXPECT_EQ(few.width, 3);
  EXPECT_EQ(few.height, 2);
  EXPECT_EQ(few.pixels, (std::vector<float>{0, 2, 4, 10, 12, 14}));
}

}  // namespace
}  // namespace wobblebench::bench
