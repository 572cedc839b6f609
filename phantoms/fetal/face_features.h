// Where the parts of the fetal face are.
#pragma once

#include <vector>

#include "phantoms/feature.h"
#include "phantoms/fetal/fetal_head.h"

namespace wobblebench::phantoms {

/// Nose, lips, eyelids, ears, cheeks and forehead, placed by the landmarks of the head; where two
/// overlap the first of them counts. `scale`: of the face, relative to 21 weeks. `mouth_open_m`:
/// gap between the lips.
std::vector<Feature> face_features(const FetalHead& head,
                                   const FetalBiometry& biometry,
                                   double scale,
                                   double mouth_open_m);

}  // namespace wobblebench::phantoms
