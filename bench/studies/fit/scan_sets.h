// Which scans the detection-error model is fitted to, and which it is judged on.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// One scene at one pose, with its seeds.
struct ScanSet {
  std::string name;
  std::string of;  ///< what is new about it to a model that was fitted to the training sets
  Scene scene;
  std::vector<std::uint64_t> seeds;
};

/// The scene at three poses and in another view, with `count` seeds each, or half as many in the
/// view and with twice the buffer, half the frames and half the sticks.
std::vector<ScanSet> training_sets(const Scene& scene, int count);
/// The scene with other seeds, at another pose, in another view.
std::vector<ScanSet> held_out_sets(const Scene& scene);
/// Ball, slanting plane and steps, but what the scene has.
std::vector<ScanSet> other_phantoms(const Scene& scene);

}  // namespace wobblebench::bench
