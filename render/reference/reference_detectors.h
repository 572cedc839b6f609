// The detectors of pass 2 in double precision, written for clarity.
#pragma once

#include <memory>
#include <optional>

#include "render/options.h"

namespace wobblebench::render::reference {

/// Finds the surface along one ray.
class SurfaceFinder {
 public:
  virtual ~SurfaceFinder() = default;
  SurfaceFinder() = default;
  SurfaceFinder(const SurfaceFinder&) = delete;
  SurfaceFinder& operator=(const SurfaceFinder&) = delete;

  /// The ray is outside the cone.
  virtual void reset() = 0;
  /// Adds the sample at this ray length; returns z if it completes an edge.
  virtual std::optional<double> take(double sample, double distance_m) = 0;
};

/// Of RayCastingOptions::detector. `level`: detection_level() of the volume.
std::unique_ptr<SurfaceFinder> make_surface_finder(const RenderOptions& options, double level);

}  // namespace wobblebench::render::reference
