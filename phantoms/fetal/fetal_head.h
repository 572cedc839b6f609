// The fetal head as shapes, in its own frame: metres, origin between the eyes on the face, x to
// the right of somebody who looks at the face, y towards the chin, z towards the occiput.
#pragma once

#include "phantoms/fetal/fetal_biometry.h"
#include "phantoms/fetal/fetal_landmarks.h"
#include "phantoms/shapes/sculpture.h"

namespace wobblebench::phantoms {

struct FetalHead {
  Sculpture skin;
  Sculpture skull;    ///< outer surface of the bone, face bones included
  Sculpture brain;    ///< inner surface of the braincase
  Ellipsoid eyes[2];  ///< globes that fill the orbits, at -x and +x
  FetalLandmarks landmarks;
};

/// The head of average biometry. Lip and chin heights are solved so that the finished profile, as
/// a caliper finds its extremes, has the philtrum and chin length of `biometry`.
FetalHead sculpt_head(const FetalBiometry& biometry);

}  // namespace wobblebench::phantoms
