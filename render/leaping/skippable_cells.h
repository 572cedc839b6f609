// Where a ray can find nothing: cells of the slices in which no edge fires and nothing is visible.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "render/leaping/macrocells.h"
#include "render/options.h"
#include "render/passes/slice_geometry.h"

namespace wobblebench::render {

/// Greatest changes from one pixel to the next along an axis, upwards and downwards.
struct Steps {
  float rise = 0, fall = 0;
};

/// What a cell between two frames holds: its pixels in both slices, and those that a fetch in it
/// reads besides.
struct MacrocellBounds {
  float low = 0, high = 0;  ///< least and greatest value
  Steps x, depth;           ///< within a slice
  Steps frame;              ///< from the first slice to the second
};

/// Decides exactly, from bounds of the slices, which cells rays may pass without looking.
///
/// What rays sample is linear between pixels and frames, so the greatest changes from pixel to
/// pixel bound how steeply it rises along a ray. The newer half of the buffer's n samples lies
/// n / 2 steps behind the older, sample by sample, so Difference <= (n / 2)^2 step slope: where
/// that stays below the threshold in all that the buffer reaches back to, no edge fires. Where the
/// transfer function is transparent between low and high, nothing is visible.
///
/// A ray must sample everything where there is a lone frame, or the wobble axis lies in the field:
/// what follows takes neighbouring frames to be neighbours in space.
class SkippableCells {
 public:
  /// `pixels`: those that rays read.
  SkippableCells(const hw::AcquisitionPlan& plan,
                 const SliceGeometry& geometry,
                 const RenderOptions& options,
                 const Region& pixels);

  /// [row][column] of one interval. One never given counts as zeros.
  void set_bounds(int interval, std::vector<MacrocellBounds> bounds);
  /// Where the picture is seen from: what is steep, and where the buffer reaches, depends on where
  /// rays run.
  void look(const RenderOptions& options);

  /// For each cell ([interval][row][column]), how many cells away the nearest is that a ray must
  /// sample, along the farthest axis, at most kFarthestCell; 0: this one. Cells on the cone's
  /// border must be sampled, so that a ray notices when it leaves.
  std::vector<std::uint8_t> distances() const;

  const MacrocellGrid& lattice() const { return lattice_; }
  /// False where every cell must be sampled, whatever the slices hold.
  bool can_leap() const { return can_leap_; }

 private:
  /// Least and greatest part of a ray's unit direction along an axis.
  struct Range {
    double low = 0, high = 0;
  };
  /// Where rays run in an interval: along x, away from the wobble axis, and about it.
  struct Directions {
    Range x, away, about;
  };
  /// A length behind each sample that counts for it, and one all around.
  struct Reach {
    double behind_m = 0, around_m = 0;
  };
  enum class Place : std::uint8_t { inside, border, outside };

  Place place_of(int column, int row) const;
  double arm_m(int row) const;
  Directions directions(int interval, double margin_rad) const;
  double steepest_per_m(const MacrocellBounds& bounds, const Directions& along, double arm_m) const;
  bool is_visible(float low, float high) const;
  CellBits to_sample() const;
  CellBits dilated(const CellBits& bits, const Reach& reach) const;

  SliceGeometry geometry_;
  MacrocellGrid lattice_;
  double pixel_x_m_, pixel_depth_m_, phi_step_rad_;
  bool can_leap_;
  bool detects_, rising_;
  double steepest_quiet_per_m_;    ///< slope along a ray below which no edge fires
  std::vector<int> next_visible_;  ///< entry of the transfer table at or after this one
  Reach buffer_, kernel_;
  std::vector<Place> places_;                         ///< [row][column]
  std::vector<std::vector<MacrocellBounds>> bounds_;  ///< [interval][row][column]
  glm::dvec3 forward_{0, 0, 1};
  double spread_ = 0;  ///< how far rays' unit directions lie from `forward_`
};

}  // namespace wobblebench::render
