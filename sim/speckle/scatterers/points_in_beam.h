// A phantom's point scatterers, as one stick finds them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/optics/beam_table.h"
#include "sim/speckle/scatterers/stick_path.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// True range up to which scatterers echo within what remains of a stick, a pulse beyond its last
/// sample.
double echo_range_m(const StickPath& path);

/// Holds the working memory of one thread. What it finds is valid until the next call.
class PointsInBeam {
 public:
  PointsInBeam(const ScannedTissue& tissue, const BeamTable& beam);

  /// Those within the beam's reach of the stick's axis, an ellipse at each range, where they are at
  /// the stick's time, up to a true range.
  std::span<const PointEcho> find(const TimedRay& line, double to_m);
  /// The same as far as sound remains.
  std::span<const PointEcho> find(const StickPath& path);

 private:
  /// Of the beam at the ranges of a row of its table.
  struct Reach {
    double lateral_m;
    double elevation_m;
  };
  struct Stick {
    hw::Ray ray;
    AcrossStick across;
    double to_m;
    phantoms::Deformation now;
  };

  void find_fixed(const Stick& stick);
  void add_if_near(const phantoms::PointScatterer& point, const Stick& stick);

  ScannedTissue tissue_;
  double rows_per_m_;
  std::vector<Reach> reaches_;
  double widest_m_ = 0;
  /// Of fixed points, by coordinate, for vectorised loops.
  std::vector<float> x_m_, y_m_, z_m_;
  std::vector<std::uint32_t> fixed_, moving_;  ///< indices of points
  std::vector<std::uint8_t> near_;             ///< of each fixed point
  std::vector<PointEcho> found_;
};

}  // namespace wobblebench::sim
