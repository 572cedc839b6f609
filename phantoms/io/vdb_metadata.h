// Keys of a phantom's metadata in its .vdb.
#pragma once

#include <string>

namespace wobblebench::phantoms {

inline constexpr int kFormatVersion = 1;
inline constexpr const char* kVersionKey = "wobblebench_phantom_version";

// Of a phantom with a joint: all three or none.
inline constexpr const char* kJointCenterKey = "joint_center_m";
inline constexpr const char* kJointInnerKey = "joint_inner_m";
inline constexpr const char* kJointOuterKey = "joint_outer_m";

// Of a joint with a mouth: all of them or none.
inline constexpr const char* kMouthCenterKey = "mouth_center_m";
inline constexpr const char* kMouthAxisKeys[] = {"mouth_right", "mouth_down", "mouth_back"};
inline constexpr const char* kMouthOpeningKey = "mouth_opening_m";
inline constexpr const char* kMouthReachKey = "mouth_reach_m";

/// Point scatterers, as scatterers_to_csv() writes them; missing: there are none.
inline constexpr const char* kScatterersKey = "scatterers";

inline std::string key_of(const char* list, int index, const char* field) {
  return std::string(list) + "." + std::to_string(index) + "." + field;
}

}  // namespace wobblebench::phantoms
