#include "render/gl/fetch_count.h"

#include <glad/gl.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "render/gl/host_state.h"
#include "render/gl/program.h"

namespace wobblebench::render {
namespace {

using Sampler = TextureFetch::Sampler;

FetchCounter* active_counter = nullptr;  ///< one per process, as glad's table of entry points

constexpr int kFetchedUnit = 0;

Defines sampler_defines() {
  return Defines()
      .add("SAMPLER_PLANE", static_cast<int>(Sampler::plane))
      .add("SAMPLER_VOLUME", static_cast<int>(Sampler::volume))
      .add("SAMPLER_LAYERS", static_cast<int>(Sampler::layers));
}

}  // namespace

Defines fetch_count_defines() {
  return sampler_defines().add("FETCH_COUNT_LOCATION", kFetchCountLocation);
}

Defines fetch_rate_defines(Sampler sampler, int taps, int side) {
  return sampler_defines()
      .add("BIND_FETCHED", kFetchedUnit)
      .add("SAMPLER", static_cast<int>(sampler))
      .add("TAPS", taps)
      .add("SIDE", side);
}

TextureFetch texture_fetch_of(const Texture& texture) {
  const Extent& extent = texture.extent();
  const Sampler layered = extent.array ? Sampler::layers : Sampler::volume;
  return {extent.depth ? layered : Sampler::plane, texture.format(), texture.filter()};
}

FetchCounter::FetchCounter() {
  if (active_counter) throw std::logic_error("FetchCounter: one lives already");
  active_counter = this;
}

FetchCounter::~FetchCounter() {
  active_counter = nullptr;
}

FetchCounter* FetchCounter::current() {
  return active_counter;
}

FetchCounts FetchCounter::take() {
  return std::exchange(counts_, {});
}

void FetchCounter::begin_draw(const Framebuffer& target) {
  per_pixel_ = Texture("fetches", TexelFormat::rgba32f, target.extent(), TextureFilter::nearest);
  target.attach(kFetchCountLocation, &per_pixel_);
}

void FetchCounter::end_draw(const Framebuffer& target,
                            const std::array<TextureFetch, kSamplers>& fetches) {
  const std::vector<float> pixels = per_pixel_.download();
  target.attach(kFetchCountLocation, nullptr);
  std::array<std::int64_t, kSamplers> totals{};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i % 4 < kSamplers) totals[i % 4] += static_cast<std::int64_t>(pixels[i]);
  }
  for (std::size_t sampler = 0; sampler < kSamplers; ++sampler) {
    if (totals[sampler] > 0) counts_[fetches[sampler]] += totals[sampler];
  }
}

double fetch_rate_per_us(const TextureFetch& fetch) {
  constexpr int kSide = 512, kTaps = 64, kLayers = 2, kDraws = 7;
  const HostState host;
  const bool is_plane = fetch.sampler == Sampler::plane;
  const bool is_array = fetch.sampler == Sampler::layers;
  const Texture fetched(
      "fetched", fetch.format, {kSide, kSide, is_plane ? 0 : kLayers, is_array}, fetch.filter);
  const Texture sums("sums", TexelFormat::r32f, {kSide, kSide}, TextureFilter::nearest);
  const Framebuffer target({&sums});
  const FragmentProgram program({"fetch_rate.frag.glsl"},
                                fetch_rate_defines(fetch.sampler, kTaps, kSide));
  double best_us = std::numeric_limits<double>::max();
  for (int draw = 0; draw < kDraws; ++draw) {
    glFinish();
    const auto start = std::chrono::steady_clock::now();
    program.draw(target, {{kFetchedUnit, &fetched}});
    glFinish();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    best_us = std::min(best_us, took.count());
  }
  check_gl("measuring fetches");
  return double{kSide} * kSide * kTaps / best_us;
}

}  // namespace wobblebench::render
