#include "render/passes/pieces.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "render/camera.h"
#include "render/picture.h"

namespace wobblebench::render {
namespace {

/// The pixels of one piece, from one of its pixels on; marks them as seen.
std::vector<std::pair<int, int>> piece_from(const Image<double>& depth_m,
                                            std::pair<int, int> first,
                                            double step_m,
                                            Image<char>& seen) {
  std::vector<std::pair<int, int>> piece = {first};
  seen.at(first.first, first.second) = 1;
  for (std::size_t next = 0; next < piece.size(); ++next) {
    const auto [column, row] = piece[next];
    const double z = depth_m.at(column, row);
    constexpr std::pair<int, int> kNeighbours[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (const auto& [right, down] : kNeighbours) {
      const int c = column + right, r = row + down;
      if (c < 0 || r < 0 || c >= depth_m.width || r >= depth_m.height || seen.at(c, r)) continue;
      if (!(std::abs(depth_m.at(c, r) - z) <= step_m)) continue;
      seen.at(c, r) = 1;
      piece.emplace_back(c, r);
    }
  }
  return piece;
}

}  // namespace

void drop_small_pieces(Image<double>& depth_m, const RenderOptions& options) {
  if (options.ray_casting.smallest_piece_m2 == 0) return;
  const double pixel_m = make_camera(options).pixel_m();
  const double step_m = std::max(kPieceStep_m, 4 * pixel_m);
  const double least_pixels = options.ray_casting.smallest_piece_m2 / (pixel_m * pixel_m);
  Image<char> seen(depth_m.width, depth_m.height);
  for (int row = 0; row < depth_m.height; ++row) {
    for (int column = 0; column < depth_m.width; ++column) {
      if (seen.at(column, row) || !std::isfinite(depth_m.at(column, row))) continue;
      const auto piece = piece_from(depth_m, {column, row}, step_m, seen);
      if (static_cast<double>(piece.size()) >= least_pixels) continue;
      for (const auto& [c, r] : piece) depth_m.at(c, r) = kNoSurface;
    }
  }
}

}  // namespace wobblebench::render
