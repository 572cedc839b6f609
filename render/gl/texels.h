// Kinds of texture fetches, by the properties that determine their cost.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>

#include "render/gl/texel_format.h"

namespace wobblebench::render {

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

}  // namespace wobblebench::render
