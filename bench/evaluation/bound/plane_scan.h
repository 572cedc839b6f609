// Simulated sticks across a tilted plane, with what an oracle knows of each.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "bench/evaluation/bound/detection_bound.h"
#include "phantoms/placed_phantom.h"
#include "sim/optics/beam_table.h"
#include "tests/bench/evaluation/bound/oracle.h"
#include "tests/bench/evaluation/bound/plane_oracle.h"

namespace wobblebench::bench {

/// The plane in front of the probe, and its closed form.
struct TiltedPlane {
  phantoms::PlacedPhantom subject;
  glm::dvec3 place;
  glm::dvec3 normal;  ///< out of the tissue

  TiltedPlane(const PlaneCell& cell, double face_m);
  double range_m(const hw::Ray& stick) const;
};

/// One stick: what the oracle knows of it.
struct PlaneStick {
  hw::StickIndex index;
  double edge_m = 0;
  DetectionConditions conditions;
  EdgeSignal signal;
  double first_m = 0;
  int first_sample = 0;
  int samples = 0;
  double bound_m = 0;  ///< of `signal`
};

/// The sticks of a cell.
class PlaneScan {
 public:
  explicit PlaneScan(const PlaneCell& cell);

  const std::vector<PlaneStick>& sticks() const { return sticks_; }
  const hw::AcquisitionPlan& plan() const { return plan_; }

  /// `scatterers`: moved as it is; its beam hardly varies within an error of the oracle.
  EdgeSignal signal_at(const PlaneStick& stick, double edge_m) const;

  /// [stick][seed], the samples of each stick's window.
  std::vector<std::vector<IqSamples>> samples() const;

 private:
  PlaneStick stick(const hw::StickIndex& index) const;
  /// The rung `field` takes the beam's width at each sample.
  EdgePair field_pair(const hw::PolarPoint& place, const DetectionConditions& at_edge) const;
  void place_window(PlaneStick& stick) const;

  PlaneCell cell_;
  hw::AcquisitionPlan plan_;
  sim::SimulationOptions options_;
  TiltedPlane plane_;
  sim::BeamProfile profile_;
  std::optional<sim::BeamTable> beam_;
  std::vector<PlaneStick> sticks_;
};

}  // namespace wobblebench::bench
