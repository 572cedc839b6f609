// The pose of a fetal head in a scan of which nothing else is known, and the view and box that show
// it upright and whole.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/scene/scene.h"
#include "hw/probe/polar_volume.h"
#include "render/options.h"

namespace wobblebench::bench {

/// From the frame of phantoms::MeanHead to the probe frame: scale * rotation * head + position.
struct HeadPose {
  glm::dmat3 rotation{1.0};
  glm::dvec3 position_m{0};
  double scale = 1;
  /// Of the sticks that would meet the mean head there, how well they do: 1 where each has its edge
  /// on it; an edge 4 mm before it counts 0, one 4 mm behind it -1.
  double matched = 0;
  /// The best match of a head turned by 35 degrees or more from this, over this one's: near 1 of a
  /// ball, which has no face.
  double rival = 0;

  /// Whether it is a head, and one whose pose is known: matched >= 0.36, rival <= 0.9.
  bool is_head() const;
};

/// Lays the mean head onto the surface that faces the probe behind fluid, from several hundred
/// orientations in which its face is turned to the probe by 60 degrees or less, and returns what
/// matches best; `matched` is 0 where there is no such surface. Takes about a second.
HeadPose find_head(const hw::PolarVolume& volume);

/// View and box of a head, in whole degrees and millimetres: seen from before, upright, with all of
/// its face and its ears.
struct HeadView {
  render::ViewOptions view;
  render::VolumeOfInterest box;
};
HeadView head_view(const HeadPose& pose);

/// Dotted keys and values, in the order of the options.
nlohmann::ordered_json settings_of(const HeadView& head);

/// Sets what the user did not give. Returns it as --set takes it, and what was given and kept.
std::string set_head_view(const HeadView& head, Scene& scene);

}  // namespace wobblebench::bench
