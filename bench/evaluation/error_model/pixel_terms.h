// What the detection-error model knows of a pixel: all of it measured, none of it the truth.
#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "base/image.h"
#include "hw/probe/polar_volume.h"
#include "render/options.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Terms of the bias, in millimetres where nothing else is said. An incidence has two parts: in the
/// image plane and across it.
enum ErrorTerm {
  kConstantTerm,      ///< 1
  kBufferTerm,        ///< buffer length x step; 0 of a detector without a buffer
  kLateralTerm,       ///< lateral beam width x sin(incidence in the image plane)
  kElevationTerm,     ///< elevation beam width x sin(incidence across it)
  kLineSpacingTerm,   ///< line spacing x sin(incidence in the image plane)
  kFrameSpacingTerm,  ///< frame spacing x sin(incidence across it)
  kContrastTerm,      ///< sample values behind less before the surface, 0 to 0.45 of full scale
  kDepthTerm,         ///< range less 75 mm
  kTangentTerm,       ///< render.ray_casting.incidence_correction_mm x tan(incidence), at most
                      ///< kMaxTangent
  kWeakEdgeTerm,      ///< both beam terms together x what the contrast is below 0.45
  kBumpTerm,          ///< how much nearer z is than the plane fitted about it, within 1 mm
};
inline constexpr std::size_t kErrorTerms = 11;

struct TermDescription {
  const char* name;
  const char* unit;  ///< of the coefficient
  const char* meaning;
};
const std::array<TermDescription, kErrorTerms>& error_terms();

struct PixelTerms {
  bool measured = false;  ///< the pixel has a surface
  std::array<float, kErrorTerms> x{};
  float incidence_rad = 0;  ///< between stick and measured normal
};

/// Measures the terms of pictures of one plan and one set of render options.
class TermMeter {
 public:
  /// `simulation`: the apodisation of the beam whose widths are used.
  TermMeter(const hw::AcquisitionPlan& plan,
            const sim::SimulationOptions& simulation,
            const render::RenderOptions& render);
  ~TermMeter();
  TermMeter(const TermMeter&) = delete;
  TermMeter& operator=(const TermMeter&) = delete;

  /// `filtered_depth_m`: z after pass 3's filter; normals are those of a plane fitted to it within
  /// kNormalReach_m. `volume`: log-compressed samples.
  Image<PixelTerms> measure(const Image<float>& filtered_depth_m,
                            const hw::PolarVolume& volume) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Half side of the window of the plane that gives the measured normal.
inline constexpr double kNormalReach_m = 2e-3;
/// The same of the plane that a bump stands out from.
inline constexpr double kBumpReach_m = 4e-3;
/// Contrast is the mean over this length behind the surface less that before it; beyond the limit
/// an edge is found where it is.
inline constexpr double kContrastReach_m = 5e-3;
inline constexpr double kMostContrast = 0.45;

}  // namespace wobblebench::bench
