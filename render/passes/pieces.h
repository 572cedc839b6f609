// Connected pieces of the surface in a picture.
#pragma once

#include "base/image.h"
#include "render/options.h"

namespace wobblebench::render {

/// Neighbouring pixels whose z differ by more than this, or by more than four pixels, are of two
/// pieces.
inline constexpr double kPieceStep_m = 5e-3;

/// Leaves out (kNoSurface) the pieces of z, metres, that cover less than
/// RayCastingOptions::smallest_piece_m2 of the plane through the centre of the volume of interest.
/// Pixels are neighbours in four directions.
void drop_small_pieces(Image<double>& depth_m, const RenderOptions& options);

}  // namespace wobblebench::render
