// Number of texture fetches of shaders, and the rate at which the GPU can fetch: a lower bound on a
// pass's time.
#pragma once

#include <array>
#include <cstddef>

#include "render/gl/objects.h"
#include "render/gl/texels.h"

namespace wobblebench::render {

class Defines;

/// Values of TextureFetch::Sampler.
inline constexpr std::size_t kSamplers = 3;
/// Colour attachment and output location of the counts: behind those of any pass.
inline constexpr int kFetchCountLocation = 7;

/// Defines of fetch_count.glsl.
Defines fetch_count_defines();
/// Defines of fetch_rate.frag.glsl: `taps` fetches per pixel of a square of `side` pixels, from the
/// texture bound to unit 0.
Defines fetch_rate_defines(TextureFetch::Sampler sampler, int taps, int side);

/// The kind of a fetch from this texture.
TextureFetch texture_fetch_of(const Texture& texture);

/// Counts the fetches of all programs made while it exists (shaders/fetch_count.glsl), which slows
/// them. At most one exists in a process (std::logic_error); it must outlive those programs.
class FetchCounter {
 public:
  FetchCounter();
  ~FetchCounter();
  FetchCounter(const FetchCounter&) = delete;
  FetchCounter& operator=(const FetchCounter&) = delete;

  /// The one that exists, or null.
  static FetchCounter* current();

  /// Counts of all draws since the last call.
  [[nodiscard]] FetchCounts take();

  /// Called before and after a draw. `fetches`: the kinds of the textures that it reads, by
  /// Sampler; of two textures read through samplers of one type, both count as the first.
  void begin_draw(const Framebuffer& target);
  void end_draw(const Framebuffer& target, const std::array<TextureFetch, kSamplers>& fetches);

 private:
  Texture per_pixel_;  ///< fetches of each pixel of a draw, by Sampler
  FetchCounts counts_;
};

/// Highest rate in millions of fetches per second: 64 per pixel over a whole picture, neighbouring
/// pixels reading neighbouring texels as rays do; the fastest of several draws.
[[nodiscard]] double fetch_rate_per_us(const TextureFetch& fetch);

}  // namespace wobblebench::render
