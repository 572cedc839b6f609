// Agreement of the depth pictures of modes fast and plain.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "hw/probe/polar_volume.h"
#include "render/gl/context.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// How two depth pictures of one volume differ; lengths in steps of the ray.
///
/// A pixel has changed where only one picture has a surface, or where the two surfaces are more
/// than kSameSurfaceSteps apart. Where Difference equals the threshold within rounding, one mode
/// may detect that edge and the other the next one; finite precision cannot avoid it.
struct DepthAgreement {
  std::int64_t pixels = 0;
  std::int64_t both_hit = 0;
  std::int64_t one_hit = 0;    ///< a surface in only one of the pictures
  std::int64_t elsewhere = 0;  ///< in both, more than kSameSurfaceSteps apart
  double rms_steps = 0;        ///< over the pixels that both hit, `elsewhere` left out
  double rms_all_steps = 0;    ///< over all that both hit
  double worst_steps = 0;

  double changed_percent() const {
    return 100.0 * static_cast<double>(one_hit + elsewhere) / static_cast<double>(pixels);
  }
  /// The same picture: RMS of kMostRmsSteps at most, and kMostChangedPercent at most changed.
  bool same() const;
};

inline constexpr double kSameSurfaceSteps = 1;
inline constexpr double kMostRmsSteps = 0.1;
inline constexpr double kMostChangedPercent = 0.1;

/// `step_m`: render::step_m() of both. Throws std::invalid_argument for pictures of two sizes.
DepthAgreement compare_depths(const Image<float>& one, const Image<float>& other, double step_m);

struct Direction {
  std::string name;
  double yaw_rad = 0, pitch_rad = 0;
};

/// Front, both sides, above, and along the front face.
const std::vector<Direction>& five_directions();

/// One phantom from one direction.
struct ModeAgreement {
  std::string phantom;
  Direction direction;
  DepthAgreement depth;
};

/// Renders the volume in both modes from each of five_directions(); in both the 3D kernel lies as
/// `options` say. Throws as render::Renderer does.
std::vector<ModeAgreement> measure_mode_agreement(const std::string& phantom,
                                                  const hw::PolarVolume& volume,
                                                  const render::RenderOptions& options,
                                                  render::GlContext& context,
                                                  const PartDone& done = {});

}  // namespace wobblebench::bench
