// Names of a phantom's metadata in its .vdb. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/openvdb.h>

#include <glm/vec3.hpp>
#include <string>

namespace wobblebench::phantoms {

inline constexpr int kFormatVersion = 1;
inline constexpr const char* kVersionKey = "wobblebench_phantom_version";

// All three or none: of a phantom with a joint.
inline constexpr const char* kJointCenterKey = "joint_center_m";
inline constexpr const char* kJointInnerKey = "joint_inner_m";
inline constexpr const char* kJointOuterKey = "joint_outer_m";

inline std::string key_of(const char* list, int index, const char* field) {
  return std::string(list) + "." + std::to_string(index) + "." + field;
}

inline openvdb::Vec3d to_vdb(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}
inline glm::dvec3 to_glm(const openvdb::Vec3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace wobblebench::phantoms
