// Calipers on the finished surfaces of the head: sphere tracing on their distance functions, in
// place of grids.
#pragma once

#include <string_view>
#include <vector>

#include "phantoms/fetal/face_measures.h"
#include "phantoms/fetal/fetal_head.h"

namespace wobblebench::phantoms {

/// A measure that no identity is drawn by.
struct NamedMeasure {
  std::string_view name;  ///< ends in the unit
  double value = 0;
};

struct MeasuredHead {
  FaceMeasures measures;
  std::vector<NamedMeasure> others;
  FetalLandmarks landmarks;
};

/// The measures of face_measure_laws() by their definitions, and the landmarks. `shape`: that the
/// head was built from; says about where to look.
MeasuredHead measure_head(const FetalHead& head, const HeadShape& shape);

/// A point of the skin, named as in anthropometry (docs/labels.md says how each is found).
struct NamedPoint {
  std::string_view name;
  glm::dvec3 head_m{0};
};

/// All that the head has: an open mouth has no stomion.
std::vector<NamedPoint> named_points(const FetalHead& head, const HeadShape& shape);

}  // namespace wobblebench::phantoms
