// Synthetic volumes, sampled from a formula at the position of each sample, and comparisons of
// pictures.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <tuple>

#include "hw/probe/polar_volume.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::render::testing {

/// Sample value at a position of the probe frame.
using Field = std::function<double(const glm::dvec3&)>;

/// Motor angle of a stick.
using MotorLaw = std::function<double(const hw::StickIndex&)>;

/// `volume`: its index in the stream. `law`: where the motor is; empty: where the plan has it.
hw::PolarVolume sample_field(const hw::AcquisitionPlan& plan,
                             const Field& field,
                             std::uint32_t volume = 0,
                             const MotorLaw& law = {});

/// Sample value at a signed distance from a surface, negative inside: `inside` or `outside`, with a
/// linear ramp of this width across the surface (0: a step).
double soft_step(double distance_m, double inside, double outside, double ramp_m);

Field sphere(const glm::dvec3& center_m, double radius_m, double ramp_m);
/// The half space beyond `point`; `normal` points to the probe.
Field plane(const glm::dvec3& point_m, const glm::dvec3& normal, double ramp_m);
/// The field plus uniform noise of this amplitude, a hash of position and seed.
Field noisy(Field field, double amplitude, std::uint64_t seed);

/// A small acquisition, dense enough for its field of view, and settings that render it fast.
hw::AcquisitionPlan small_plan();
RenderOptions small_options();

/// A noisy sphere with a soft edge in front of a tilted plane.
const hw::PolarVolume& noisy_scene();

/// Name of a test with parameters (case with a name, mode).
struct NamedByCaseAndMode {
  template <class Info>
  std::string operator()(const Info& info) const {
    const bool fast = std::get<1>(info.param) == PipelineMode::fast;
    return std::string(std::get<0>(info.param).name) + (fast ? "_fast" : "_plain");
  }
};

inline constexpr double kInside = 0.9, kOutside = 0.1;

/// Difference of two depth images.
struct DepthDifference {
  double rms_m = 0;
  double largest_m = 0;
  double changed_share = 0;  ///< share of pixels with a surface in only one
  int both = 0;              ///< pixels with a surface in both
};
DepthDifference compare(const Image<float>& a, const Image<float>& b);

/// Difference of two pictures: the largest of any channel, and the share of pixels in which it
/// exceeds `tolerance`.
struct ColorDifference {
  double largest = 0;
  double failing_share = 0;
};
ColorDifference compare(const Image<glm::vec3>& a, const Image<glm::vec3>& b, double tolerance);

/// Bitwise, so that NaN (no surface) equals itself.
template <class Pixel>
bool same_bits(const Image<Pixel>& a, const Image<Pixel>& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Pixel)) == 0;
}

/// Pixels with a surface.
int hits(const Image<float>& depth_m);

}  // namespace wobblebench::render::testing
