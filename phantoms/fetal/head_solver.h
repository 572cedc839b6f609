// Shapes whose finished surfaces have given measures.
#pragma once

#include "phantoms/fetal/face_identity.h"
#include "phantoms/fetal/fetal_head.h"
#include "phantoms/fetal/head_measures.h"

namespace wobblebench::phantoms {

struct SolvedHead {
  HeadShape shape;
  FetalHead head;
  MeasuredHead measured;
};

/// Largest difference of a measure and its target, in its unit; of ratios a tenth of that.
inline constexpr double kMostResidual = 0.3;

/// Unit of the shape of a face with these measures: its size against the mean face of 21 weeks, by
/// width, height and distance of the eyes, times 1 mm.
double face_unit_m(const FaceMeasures& measures);

/// The head of `identity`, mouth closed: each parameter of the shape is set by a secant iteration
/// on the measure that it changes most. Throws InvalidPhantom, one line with measure, target and
/// what can be reached, where a target is missed by more than kMostResidual.
SolvedHead solve_head(const FaceIdentity& identity);

}  // namespace wobblebench::phantoms
