// How often shaders fetch, and how often they could: the floor under a pass's time.
#pragma once

#include <array>
#include <cstddef>

#include "render/gl/objects.h"
#include "render/gl/texture_fetch.h"

namespace wobblebench::render {

inline constexpr std::size_t kSamplers = 3;

TextureFetch kind_of(const Texture& texture);

/// While one lives, programs that are made count their fetches (shaders/fetch_count.glsl), which
/// slows them. One at a time; it must outlive those programs.
class FetchCounter {
 public:
  FetchCounter();
  ~FetchCounter();
  FetchCounter(const FetchCounter&) = delete;
  FetchCounter& operator=(const FetchCounter&) = delete;

  /// The one that lives; null: none.
  static FetchCounter* current();

  /// Of all draws since the last call.
  FetchCounts take();

  /// Around one draw, `kinds`: of the textures that it reads, by Sampler. Where it reads two
  /// textures through samplers of one type, both count as the first.
  void begin_draw(const Framebuffer& target);
  void end_draw(const Framebuffer& target, const std::array<TextureFetch, kSamplers>& kinds);

 private:
  Texture fetches_;  ///< of each pixel of a draw, by Sampler
  FetchCounts counts_;
};

/// Millions of fetches a second, at best: 64 a pixel in a loop over a picture, neighbouring pixels
/// reading neighbouring places, as rays do; the fastest of several draws.
double fetch_rate_per_us(const TextureFetch& kind);

}  // namespace wobblebench::render
