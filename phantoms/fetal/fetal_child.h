// The child that the options of fetal_face ask for: identity, anomalies, expression and pose of the
// head.
#pragma once

#include <vector>

#include "phantoms/fetal/head_solver.h"
#include "phantoms/options.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

struct FetalChild {
  FaceMeasures targets;  ///< of the identity, with the anomalies
  SolvedHead solved;     ///< with the expression; landmarks with the pose
};

/// Throws InvalidPhantom, one line that names identity and age, for a face that cannot be built.
FetalChild make_child(const PhantomOptions& options);

/// What the finished surfaces measure, by name, with the targets of what was drawn.
std::vector<PhantomMeasure> measures_of(const FetalChild& child);

}  // namespace wobblebench::phantoms
