// The fetal head as CSG bodies, in the head frame: metres, origin between the eyes on the face, x
// to the right of an observer facing it, y towards the chin, z towards the occiput.
#pragma once

#include "phantoms/fetal/fetal_biometry.h"
#include "phantoms/fetal/fetal_landmarks.h"
#include "phantoms/shapes/csg_body.h"

namespace wobblebench::phantoms {

struct FetalHead {
  CsgBody skin;
  CsgBody skull;      ///< outer surface of the bone, face bones included
  CsgBody brain;      ///< inner surface of the braincase
  Ellipsoid eyes[2];  ///< globes filling the orbits, at -x and +x
  FetalLandmarks landmarks;
};

/// The head of the given biometry. Lip and chin heights are solved for iteratively, so that the
/// extremes of the finished profile are apart by the philtrum and chin length of `biometry`.
/// `mouth_open_m`: gap between the lips; the lower jaw of the closed mouth's head is that much
/// lower.
FetalHead make_head(const FetalBiometry& biometry, double mouth_open_m);

}  // namespace wobblebench::phantoms
