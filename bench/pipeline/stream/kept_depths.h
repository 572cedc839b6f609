// Depth images of some volumes of a stream, spread evenly over it, in bounded memory.
#pragma once

#include <cstdint>
#include <vector>

#include "render/picture.h"

namespace wobblebench::bench {

struct KeptDepth {
  std::uint32_t volume = 0;
  Image<float> depth_m;
};

/// Keeps the pictures of volumes 0, n, 2 n …; n doubles whenever there would be more than `most`.
class KeptDepths {
 public:
  /// `most`: 0: none are kept.
  explicit KeptDepths(int most) : most_(static_cast<std::size_t>(most)) {}

  void add(std::uint32_t volume, const Image<float>& depth_m) {
    if (most_ == 0 || volume % every_ != 0) return;
    kept_.push_back({volume, depth_m});
    while (kept_.size() > most_) {
      every_ *= 2;
      std::erase_if(kept_, [&](const KeptDepth& kept) { return kept.volume % every_ != 0; });
    }
  }
  const std::vector<KeptDepth>& kept() const { return kept_; }

 private:
  std::size_t most_;
  std::uint32_t every_ = 1;
  std::vector<KeptDepth> kept_;
};

}  // namespace wobblebench::bench
