// How far the finished surfaces of the head reach: sphere tracing on their distance functions.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "phantoms/fetal/fetal_head.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// A ray that is followed to a surface.
struct Ray {
  glm::dvec3 origin, direction;
  glm::dvec3 at(double distance) const { return origin + distance * direction; }
};

/// First point of the surface on the ray, from either side of it.
glm::dvec3 first_point(const CsgBody& body, const Ray& ray);

/// Radius of the smallest ball about `center_m` that contains the bone, by rays from outside.
double reach_of_skull(const FetalHead& head, const glm::dvec3& center_m);
/// A point well within the skull; head frame.
glm::dvec3 middle_of_skull(const HeadShape& shape);
/// Of the skin, some 3 mm apart, by rays from outside towards this point; head frame.
std::vector<glm::dvec3> skin_points(const FetalHead& head, const glm::dvec3& center_m);
/// Bounds of the skin, about the head's origin and turned by `rotation`: its depth ends with what
/// is seen along z.
Box turned_skin(const FetalHead& head, const glm::dvec3& center_m, const glm::dmat3& rotation);

}  // namespace wobblebench::phantoms
