// Empty space of the slices: macrocells in which no edge can be detected and nothing is visible,
// sets of them as bits, and distances between them.
#pragma once

#include <cstdint>
#include <vector>

#include "render/camera.h"
#include "render/geometry/slice_geometry.h"
#include "render/gl/texels.h"
#include "render/options.h"

namespace wobblebench::render {

/// Grid of macrocells: square cells of the pixels that rays reach, times the intervals between
/// frames. The last column and row of cells may extend beyond the pixels.
struct MacrocellGrid {
  Region pixels;
  int cell_pixels = 1;  ///< per side
  int columns = 0, rows = 0, intervals = 0;
};
MacrocellGrid make_macrocell_grid(const SliceGeometry& geometry, const Region& pixels);

/// A set of cells: a word for each [interval][row], a bit for each column.
using CellBits = std::vector<std::uint64_t>;

/// A word with a bit for each column of the grid.
std::uint64_t column_mask(const MacrocellGrid& grid);

/// A row dilated by `down` columns towards column 0 and `up` columns away from it.
std::uint64_t dilated_columns(std::uint64_t bits, int down, int up);

inline constexpr int kMaxCellDistance = 255;

/// For each cell ([interval][row][column]), the Chebyshev distance in cells to the nearest one of
/// the set, at most kMaxCellDistance.
std::vector<std::uint8_t> cell_distances(const CellBits& set, const MacrocellGrid& grid);

/// Largest changes of the value from one pixel or frame to the next along an axis.
struct ChangeBounds {
  float rise = 0, fall = 0;
};

/// Bounds of a cell between two frames, over its pixels in both slices and those that a fetch in
/// the cell also reads.
struct MacrocellBounds {
  float low = 0, high = 0;  ///< of the values
  ChangeBounds x, depth;    ///< within a slice
  ChangeBounds frame;       ///< from the first slice to the second
};

/// Decides from bounds of the slices which cells rays can skip without changing the picture
/// (docs/decisions/0014-fast-rendering.md).
///
/// Samples are interpolated linearly between pixels and frames, so the largest changes from pixel
/// to pixel bound the slope along a ray. Each sample of the newer half of the buffer lies n / 2
/// steps behind one of the older half, so Difference of Eq. (1) <= (n / 2)^2 step slope: if that is
/// below the threshold over the length of the buffer, no edge is detected; nor if n / 2 times the
/// largest sample there is. If the transfer function is transparent between low and high, nothing
/// is visible.
///
/// All cells must be sampled if there is a single frame, or if the wobble axis lies in the field:
/// the bounds assume that neighbouring frames are neighbours in space.
class SkippableCells {
 public:
  /// `pixels`: those that rays read.
  SkippableCells(const hw::AcquisitionPlan& plan,
                 const SliceGeometry& geometry,
                 const RenderOptions& options,
                 const Region& pixels);

  /// Bounds of one interval, [row][column]; initially zeros.
  void set_bounds(int interval, std::vector<MacrocellBounds> bounds);
  /// Those of cells of the same grid, which are left without.
  void take_bounds(SkippableCells& other) { bounds_ = std::move(other.bounds_); }
  /// Slopes along rays and the cells that a buffer covers depend on the direction of the rays.
  void set_view(const RenderOptions& options);
  /// Detector::iso: the surface's level. A cell that lies below it holds no rising edge.
  /// Detector::floor: the rise. No sample so large, no rise.
  void set_level(double level) { level_ = level; }
  /// SliceVolume::covered().
  void set_covered(const FrameSpan& covered) { covered_ = covered; }

  /// The cells that must be sampled; all of them unless can_leap(). Those on the cone's border are
  /// among them, so that a ray detects that it leaves the cone, unless no ray of the view can come
  /// back into it.
  CellBits to_sample() const;

  const MacrocellGrid& grid() const { return grid_; }
  const SliceGeometry& geometry() const { return geometry_; }
  const Camera& camera() const { return camera_; }
  /// False if every cell must be sampled, whatever the slices hold.
  bool can_leap() const { return can_leap_; }

 private:
  /// Range of a component of rays' unit directions.
  struct Range {
    double low = 0, high = 0;
  };
  /// Directions of rays in an interval: along x, away from the wobble axis, and about it.
  struct Directions {
    Range x, radial, tangential;
  };
  /// Extent of the data that a sample depends on: upstream along the ray, and in all directions.
  struct Reach {
    double upstream_m = 0, around_m = 0;
  };
  /// Position of a cell relative to the cone of valid data.
  enum class ConeOverlap : std::uint8_t { inside, border, outside };

  /// Cells of each kind: where an edge may be, where samples are bright enough for one, where
  /// something is visible, and on the border of the cone.
  struct Classes {
    CellBits steep, bright, visible, border;
  };

  ConeOverlap cone_overlap(int column, int row) const;
  double axis_distance_m(int row) const;
  Directions directions(int interval, double margin_rad) const;
  double max_edge_slope_per_m(const MacrocellBounds& bounds,
                              const Directions& along,
                              double axis_distance_m) const;
  bool is_visible(float low, float high) const;
  bool may_hold_surface(const MacrocellBounds& bounds,
                        const Directions& along,
                        double axis_distance_m) const;
  bool rays_may_return() const;
  void classify(int interval, int row, Classes& classes) const;
  CellBits dilated(const CellBits& bits, const Reach& reach) const;

  SliceGeometry geometry_;
  MacrocellGrid grid_;
  double pixel_x_m_, pixel_depth_m_, phi_step_rad_;
  bool can_leap_;
  bool detects_, rising_;
  Detector detector_;
  double level_ = 0;
  FrameSpan covered_;
  double value_rounding_;
  double max_slope_without_edge_per_m_;  ///< along a ray
  double least_bright_value_;            ///< Detector::paper
  std::vector<int> next_visible_;  ///< first visible entry of the transfer table from this one on
  Reach buffer_, kernel_;
  std::vector<ConeOverlap> overlaps_;                 ///< [row][column]
  std::vector<std::vector<MacrocellBounds>> bounds_;  ///< [interval][row][column]
  Camera camera_;
  double spread_ = 0;  ///< largest distance of rays' unit directions from the camera's `forward`
  bool may_return_ = true;  ///< rays_may_return()
};

}  // namespace wobblebench::render
