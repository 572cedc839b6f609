// Labels: the parts of phantoms by number and name (docs/labels.md).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wobblebench::phantoms {

class Phantom;

/// Numbers never change their meaning.
enum class Part : std::uint8_t {
  none = 0,
  // Of the face.
  forehead = 1,
  brow = 2,
  eyelids = 3,
  nose = 4,
  philtrum = 5,
  upper_lip = 6,
  lower_lip = 7,
  mouth = 8,
  tongue = 9,
  chin = 10,
  jaw = 11,
  cheek = 12,
  cheekbone = 13,
  ear = 14,
  face_base = 15,
  around_mouth = 16,
  cleft = 17,
  // Of the rest of the child.
  neck = 20,
  body = 21,
  arm = 22,
  hand = 23,
  cord = 24,
  // Within the child.
  skull = 30,
  brain = 31,
  eye = 32,
  // Of the mother.
  uterine_wall = 40,
  placenta = 41,
  maternal_muscle = 42,
  maternal_fat = 43,
  maternal_skin = 44,
  amniotic_fluid = 50,
};

/// One row of the table of parts.
struct PartName {
  Part part;
  std::string_view name;     ///< of [a-z_]
  std::string_view meaning;  ///< for people
};

/// In the order of their numbers.
std::span<const PartName> part_names();

/// Labels of phantoms whose parts have no names: what no surface encloses, and the surfaces in
/// their order, by number; the last number stands for all further ones.
inline constexpr int kUnnamedBackground = 99, kFirstUnnamed = 100, kLastUnnamed = 255;

/// A label and its name.
struct LabelName {
  std::uint8_t label = 0;
  std::string name;
};

/// All labels that this phantom can have, by number.
std::vector<LabelName> label_names(const Phantom& phantom);

}  // namespace wobblebench::phantoms
