#include "render/passes/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/parallel.h"
#include "render/camera.h"
#include "render/passes/pieces.h"
#include "render/passes/surface_depth.h"
#include "render/picture.h"

namespace wobblebench::render {
namespace {

/// Beyond this angle between its normal and the stick a surface is lost, sooner or later, to noise
/// and total reflection; its border there is smoothed.
constexpr double kSteepBorder_rad = 65 * kDegree;
/// Largest distance from the border of what is drawn or left out, and of what is looked at for its
/// normal.
constexpr double kOutlineBand_m = 6e-3, kRim_m = 2e-3;
/// Neighbours that lie farther, root mean square, from the quadratic surface through them are of
/// several surfaces, as in the corner between ear and neck: none of these is continued.
constexpr double kOneSurface_m = 1e-3;

/// Blocks to a standard deviation of the Gaussian, at least.
constexpr int kBlocks = 4;
/// Sums that run over a row round in double precision.
constexpr double kRounding = 1e-6;

using Plane = Image<double>;

template <class Value>
Plane plane_of(const Plane& like, const Value& value) {
  Plane plane(like.width, like.height);
  parallel_rows(like.height, [&](int row) {
    for (int c = 0; c < like.width; ++c) plane.at(c, row) = value(c, row);
  });
  return plane;
}

/// Means over blocks of pixels; those at the right and the lower border may be smaller.
template <class Value>
Plane block_means(const Plane& like, int side, const Value& value) {
  const Plane blocks((like.width + side - 1) / side, (like.height + side - 1) / side);
  return plane_of(blocks, [&](int column, int row) {
    const int c_end = std::min((column + 1) * side, like.width);
    const int r_end = std::min((row + 1) * side, like.height);
    double sum = 0;
    for (int r = row * side; r < r_end; ++r) {
      for (int c = column * side; c < c_end; ++c) sum += value(c, r);
    }
    return sum / ((c_end - column * side) * (r_end - row * side));
  });
}

/// At a pixel, linear between the blocks' middles.
double between(const Plane& blocks, int side, int column, int row) {
  const auto place = [&](int pixel, int count) {
    return std::clamp((pixel + 0.5) / side - 0.5, 0.0, count - 1.0);
  };
  const double x = place(column, blocks.width), y = place(row, blocks.height);
  const int c = static_cast<int>(x), r = static_cast<int>(y);
  const int right = std::min(c + 1, blocks.width - 1), below = std::min(r + 1, blocks.height - 1);
  return glm::mix(glm::mix(blocks.at(c, r), blocks.at(right, r), x - c),
                  glm::mix(blocks.at(c, below), blocks.at(right, below), x - c),
                  y - r);
}

/// Mean of a row over 2 half + 1 pixels, transposed; the first and the last pixel go on beyond the
/// picture.
Plane row_means(const Plane& from, int half) {
  Plane means(from.height, from.width);
  parallel_rows(from.height, [&](int row) {
    const auto pixel = [&](int c) { return from.at(std::clamp(c, 0, from.width - 1), row); };
    double sum = 0;
    for (int c = -half; c < half; ++c) sum += pixel(c);
    for (int c = 0; c < from.width; ++c) {
      sum += pixel(c + half);
      means.at(row, c) = sum / (2 * half + 1);
      sum -= pixel(c - half);
    }
  });
  return means;
}

Plane box_mean(const Plane& from, int half) {
  return row_means(row_means(from, half), half);
}

/// By three box means: sigma^2 is three times a box's.
Plane gaussian_mean(Plane plane, double sigma) {
  const int half =
      std::max(1, static_cast<int>(std::lround(0.5 * std::sqrt(4 * sigma * sigma + 1) - 0.5)));
  for (int k = 0; k < 3; ++k) plane = box_mean(plane, half);
  return plane;
}

/// Where the surface ends changes slowly, so that it is computed on blocks of pixels.
class Outline {
 public:
  Outline(const Plane& depth_m, const hw::ProbeGeometry& geometry, const RenderOptions& options)
      : depth_m_(depth_m),
        geometry_(geometry),
        camera_(make_camera(options)),
        sigma_(options.ray_casting.outline_m / camera_.pixel_m()),
        side_(std::max(1, static_cast<int>(sigma_ / kBlocks))),
        found_(block_means(depth_m, side_, [&](int c, int r) { return has(c, r) ? 1.0 : 0.0; })) {}

  Plane smoothed() const {
    // Less what the mean of the mean falls below the mean: a curved border stays where it is.
    const Plane once = gaussian_mean(found_, sigma_ / side_);
    const Plane twice = gaussian_mean(once, sigma_ / side_);
    const Plane share =
        plane_of(found_, [&](int c, int r) { return 2 * once.at(c, r) - twice.at(c, r); });
    const Plane near = box_mean(found_, blocks(kOutlineBand_m));
    const Plane steep = steep_share();
    return plane_of(depth_m_, [&](int c, int r) {
      const double z = depth_m_.at(c, r);
      if (!is_between(near.at(c / side_, r / side_))) return z;
      const bool within = between(share, side_, c, r) >= 0.5;
      if (has(c, r) == within || between(steep, side_, c, r) <= 0.5) return z;
      return within ? continued(c, r) : static_cast<double>(kNoSurface);
    });
  }

 private:
  bool has(int c, int r) const { return std::isfinite(depth_m_.at(c, r)); }
  int blocks(double length_m) const {
    return std::max(1, static_cast<int>(std::lround(length_m / (side_ * camera_.pixel_m()))));
  }
  /// Of a mean: some pixels have a surface, and some have none.
  static bool is_between(double share) { return share > kRounding && share < 1 - kRounding; }

  /// Of the found blocks beside the border, the share that is steep.
  Plane steep_share() const {
    const int half = blocks(0.5 * kNormalWindow_m);
    const Plane weights = box_mean(found_, half);
    const Plane sums = box_mean(
        block_means(
            depth_m_, side_, [&](int c, int r) { return has(c, r) ? depth_m_.at(c, r) : 0; }),
        half);
    const Plane mean_m =
        plane_of(found_, [&](int c, int r) { return sums.at(c, r) / weights.at(c, r); });
    const Plane near = box_mean(found_, blocks(kRim_m));
    const auto in_rim = [&](int c, int r) {
      return found_.at(c, r) > 0 && is_between(near.at(c, r));
    };
    const double sigma = sigma_ / side_;
    const Plane rim = gaussian_mean(
        plane_of(found_, [&](int c, int r) { return in_rim(c, r) ? 1.0 : 0.0; }), sigma);
    const Plane steep = gaussian_mean(
        plane_of(found_,
                 [&](int c, int r) { return in_rim(c, r) && is_steep(mean_m, c, r) ? 1.0 : 0.0; }),
        sigma);
    return plane_of(found_, [&](int c, int r) {
      return rim.at(c, r) > kRounding ? steep.at(c, r) / rim.at(c, r) : 0;
    });
  }

  bool is_steep(const Plane& mean_m, int column, int row) const {
    const auto position = [&](int c, int r) {
      c = std::clamp(c, 0, mean_m.width - 1);
      r = std::clamp(r, 0, mean_m.height - 1);
      if (found_.at(c, r) == 0) c = column, r = row;
      const auto middle = [&](int block) { return side_ * (block + 0.5) - 0.5; };
      return camera_.ray(middle(c), middle(r)).at(mean_m.at(c, r));
    };
    const glm::dvec3 across = glm::cross(position(column + 1, row) - position(column - 1, row),
                                         position(column, row + 1) - position(column, row - 1));
    const hw::PolarPoint at = geometry_.to_polar(position(column, row));
    const glm::dvec3 stick = geometry_.stick(at.theta_rad, at.phi_rad).direction;
    return std::abs(glm::dot(across, stick)) < std::cos(kSteepBorder_rad) * glm::length(across);
  }

  /// z at a pixel of the quadratic surface through the found pixels about it, by weighted least
  /// squares; none where they are too few.
  double continued(int column, int row) const;

  const Plane& depth_m_;
  const hw::ProbeGeometry& geometry_;
  Camera camera_;
  double sigma_;  ///< pixels
  int side_;      ///< of a block, pixels
  Plane found_;   ///< share of each block's pixels
};

constexpr int kTerms = 6;
using Terms = std::array<double, kTerms>;

/// Normal equations of weighted least squares in the terms 1, x, y, x^2, xy, y^2.
class QuadraticFit {
 public:
  void add(double x, double y, double value, double weight) {
    const Terms terms = {1, x, y, x * x, x * y, y * y};
    for (int i = 0; i < kTerms; ++i) {
      for (int j = 0; j < kTerms; ++j) rows_[i][j] += weight * terms[i] * terms[j];
      right_[i] += weight * terms[i] * value;
    }
    squares_ += weight * value * value;
    ++count_;
  }
  int count() const { return count_; }

  struct Result {
    double at_origin = kNoSurface;  ///< where x = y = 0
    double rms = kNoSurface;        ///< of the values from the surface
  };
  /// By Gaussian elimination from the last term on, which leaves the first, and takes from the sum
  /// of squares what each term explains.
  Result solved() const {
    auto rows = rows_;
    Terms right = right_;
    double squares = squares_;
    const double weight = rows[0][0];
    for (int pivot = kTerms - 1; pivot >= 0; --pivot) {
      if (!(rows[pivot][pivot] > 1e-9 * weight)) return {};
      squares -= right[pivot] * right[pivot] / rows[pivot][pivot];
      for (int i = 0; i < pivot; ++i) {
        const double factor = rows[i][pivot] / rows[pivot][pivot];
        for (int j = 0; j < pivot; ++j) rows[i][j] -= factor * rows[pivot][j];
        right[i] -= factor * right[pivot];
      }
    }
    return {right[0] / rows[0][0], std::sqrt(std::max(0.0, squares / weight))};
  }

 private:
  std::array<Terms, kTerms> rows_{};
  Terms right_{};
  double squares_ = 0;
  int count_ = 0;
};

double Outline::continued(int column, int row) const {
  const int half = static_cast<int>(std::ceil(2 * sigma_));
  const int step = std::max(1, half / 5);
  QuadraticFit fit;
  for (int down = -half; down <= half; down += step) {
    for (int right = -half; right <= half; right += step) {
      const int c = column + right, r = row + down;
      if (c < 0 || r < 0 || c >= depth_m_.width || r >= depth_m_.height || !has(c, r)) continue;
      const double x = right / sigma_, y = down / sigma_;
      fit.add(x, y, depth_m_.at(c, r), std::exp(-0.5 * (x * x + y * y)));
    }
  }
  constexpr int kLeastPixels = 2 * kTerms;
  if (fit.count() < kLeastPixels) return kNoSurface;
  const auto [z_m, rms_m] = fit.solved();
  return rms_m <= kOneSurface_m ? z_m : static_cast<double>(kNoSurface);
}

}  // namespace

Image<double> finished_surface(const Image<double>& found_m,
                               const hw::ProbeGeometry& geometry,
                               const RenderOptions& options) {
  Image<double> depth_m = found_m;
  if (options.ray_casting.outline_m > 0) depth_m = Outline(found_m, geometry, options).smoothed();
  drop_small_pieces(depth_m, options);
  return depth_m;
}

Image<std::uint8_t> drawn_beyond(const Image<double>& found_m, const Image<double>& depth_m) {
  Image<std::uint8_t> drawn(depth_m.width, depth_m.height);
  std::ranges::transform(
      found_m.pixels, depth_m.pixels, drawn.pixels.begin(), [](double was, double is) {
        return !std::isfinite(was) && std::isfinite(is);
      });
  return drawn;
}

}  // namespace wobblebench::render
