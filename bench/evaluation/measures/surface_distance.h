// Distance between the found and the true surface in space.
#pragma once

#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// From the points of one surface to the other one; NaN where either has none.
struct DirectedDistance {
  double mean_m = 0;
  double p95_m = 0;
  double max_m = 0;
  int n = 0;
};

/// Points are those of the pixels; a surface is the triangles between neighbouring pixels whose
/// depths differ by no more than kSurfaceJump_m, and lone points. The distance of a point is that
/// to the nearest vertex or to a triangle at it.
struct SurfaceDistance {
  DirectedDistance found_to_true;  ///< all that is found, to all that is there, seen or not
  DirectedDistance true_to_found;  ///< what the probe can see, to what is found
  double mean_m = 0;               ///< over the points of both
  double p95_m = 0;                ///< likewise
  double hausdorff95_m = 0;        ///< the greater P95 of the two
};

SurfaceDistance surface_distance(const Image<float>& depth_m,
                                 const Truth& truth,
                                 const render::Camera& camera);

}  // namespace wobblebench::bench
