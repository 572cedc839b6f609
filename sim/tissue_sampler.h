// What a line of sight passes: materials and the interfaces between them. OpenVDB stays in the
// .cpp.
#pragma once

#include <memory>
#include <vector>

#include "hw/probe.h"
#include "phantoms/phantom.h"

namespace wobblebench::sim {

/// Where the material changes along a stick.
struct Interface {
  double range_m = 0;
  phantoms::MaterialIndex before = 0;
  phantoms::MaterialIndex behind = 0;
  double cos_incidence = 1;  ///< against the surface's normal, 0 to 1
};

/// A stretch of samples within one material: [first, last).
struct Stretch {
  int first = 0;
  int last = 0;
  phantoms::MaterialIndex material = 0;
};

/// A stick's way through the phantom, nearest first; stretches cover all samples without gaps.
struct TissueProfile {
  std::vector<Stretch> stretches;
  std::vector<Interface> interfaces;
};

/// Samples a phantom along sticks. One object serves one thread; make one for each.
class TissueSampler {
 public:
  TissueSampler(const phantoms::Phantom& phantom, const phantoms::Placement& placement);
  TissueSampler(TissueSampler&&) noexcept;
  ~TissueSampler();

  /// `count` samples at ranges (i + 1/2) * spacing_m along `stick` (probe frame).
  TissueProfile profile(const hw::Ray& stick, double spacing_m, int count);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace wobblebench::sim
