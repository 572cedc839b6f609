// Plain values that describe textures: formats of texels, rectangles of them, and kinds of fetches,
// by the properties that determine their cost.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>

namespace wobblebench::render {

enum class TexelFormat { r8, r16, r32f, rg8, rg16, rg32f, rgba8, rgba16, rgb32f, rgba32f };
enum class TextureFilter { nearest, linear };

/// A kind of fetch. A texelFetch counts as a nearest one.
struct TextureFetch {
  enum class Sampler { plane, volume, layers };  ///< sampler2D, sampler3D, sampler2DArray
  Sampler sampler = Sampler::plane;
  TexelFormat format = TexelFormat::r32f;
  TextureFilter filter = TextureFilter::nearest;

  bool operator==(const TextureFetch&) const = default;
  bool operator<(const TextureFetch& other) const {
    return std::tie(sampler, format, filter) < std::tie(other.sampler, other.format, other.filter);
  }
};

/// Number of fetches of each kind.
using FetchCounts = std::map<TextureFetch, std::int64_t>;

/// A rectangle of a picture, slice or framebuffer, in pixels.
struct Region {
  int column = 0;
  int row = 0;
  int columns = 0;
  int rows = 0;
};

}  // namespace wobblebench::render
