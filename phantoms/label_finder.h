// Which part of a phantom a point of a surface, or of what surfaces enclose, belongs to. The part
// of a point of the face is that of the shape which makes the surface there: of the operation of
// least signed distance, not of a region about it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "phantoms/parts.h"
#include "phantoms/phantom.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

/// A body of operations with parts, in a frame of its own.
struct PartBody {
  CsgBody shape;  ///< operations without effect on the parts' borders may have been left out
  glm::dmat3 to_body{1.0};
  glm::dvec3 position_m{0};  ///< of the body's origin, phantom frame
  double fillet_m = 0;       ///< to the bodies before it
};

/// What says the part of points of one surface.
struct SurfaceParts {
  Part on = Part::none;               ///< on the surface …
  Part inside = Part::none;           ///< … and within it; without effect where there are bodies
  std::vector<PartBody> bodies = {};  ///< whose union the surface is

  Part part_on(const glm::dvec3& rest_m) const;
  Part part_inside(const glm::dvec3& rest_m) const;
};

/// Of a phantom that names its parts.
struct PhantomParts {
  Part background = Part::none;
  std::vector<SurfaceParts> surfaces;  ///< one for each of Phantom::surfaces()
};

/// Labels of points, in the phantom frame at rest. Threads must not share one: each takes a copy.
///
/// @code
/// #include <iostream>
/// const phantoms::Phantom ball = phantoms::make_phantom({.name = "sphere", .radius_m = 20e-3});
/// const phantoms::LabelFinder labels(ball);
/// std::cout << int{labels.at({0, 0, 0})};  // 100, the first surface
/// @endcode
class LabelFinder {
 public:
  explicit LabelFinder(const Phantom& phantom);
  LabelFinder(const LabelFinder& other);
  ~LabelFinder();

  /// Of a point on Phantom::surfaces()[surface], which nothing covers.
  std::uint8_t on_surface(int surface, const glm::dvec3& rest_m) const;
  /// Of a point that this surface encloses, and none after it.
  std::uint8_t inside(int surface, const glm::dvec3& rest_m) const;
  /// Of the tissue or fluid at a point: that of the last surface that encloses it.
  std::uint8_t at(const glm::dvec3& rest_m) const;
  /// Distance to a surface within its narrow band; beyond it at least the band's width.
  double distance_m(int surface, const glm::dvec3& rest_m) const;
  /// Index into Phantom::surfaces() of the last surface that encloses a point; -1: none does.
  int enclosing(const glm::dvec3& rest_m) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes the label of every voxel that a surface encloses as .vdb, on the voxels of the phantom's
/// first surface: a grid "part" of whole numbers as floats, whose background is the label of what
/// no surface encloses, and the names as metadata. As write_phantom() does.
void write_labels(const Phantom& phantom, const std::filesystem::path& path);

}  // namespace wobblebench::phantoms
