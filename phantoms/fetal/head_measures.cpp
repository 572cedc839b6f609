#include "phantoms/fetal/head_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "base/units.h"
#include "phantoms/fetal/head_extent.h"

namespace wobblebench::phantoms {
namespace {

// The plane of the palate rises towards the front by this angle against the plane of BPD and OFD;
// assumed: the palate is not modelled.
constexpr double kPalateTilt_deg = 10.0;

// The parameter between two limits where `value` is largest: the best of some equal steps, then
// golden section about it.
template <class Value>
double where_largest(double from, double to, int steps, const Value& value) {
  double best = from, most = value(from);
  const double step = (to - from) / steps;
  for (int i = 1; i <= steps; ++i) {
    const double here = value(from + i * step);
    if (here > most) best = from + i * step, most = here;
  }
  constexpr double kGolden = 0.6180339887498949;
  double low = std::max(best - step, from), high = std::min(best + step, to);
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = value(left), at_right = value(right);
  for (int i = 0; i < 9; ++i) {
    if (at_left > at_right) {
      high = right, right = left, at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = value(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = value(right);
    }
  }
  const double middle = 0.5 * (low + high);
  return value(middle) >= most ? middle : best;
}

// A surface in the median plane, seen from in front.
class Profile {
 public:
  Profile(const CsgBody& body, double unit_m)
      : body_(body.near({glm::dvec3(0, 2, 4) * unit_m, 52 * unit_m})), unit_m_(unit_m) {}

  glm::dvec3 at(double y) const { return first_point(body_, {{0, y, -16 * unit_m_}, {0, 0, 1}}); }
  // The point with the largest f(point) between two heights.
  template <class Value>
  glm::dvec3 largest(double from, double to, const Value& f) const {
    return at(where_largest(from, to, 10, [&](double y) { return f(at(y)); }));
  }
  glm::dvec3 deepest(double from, double to) const {
    return largest(from, to, [](const glm::dvec3& p) { return p.z; });
  }
  glm::dvec3 foremost(double from, double to) const {
    return largest(from, to, [](const glm::dvec3& p) { return -p.z; });
  }
  // Lowest point between two depths, seen from `below`.
  glm::dvec3 lowest(double from_z, double to_z, double below) const {
    const auto under = [&](double z) { return first_point(body_, {{0, below, z}, {0, -1, 0}}); };
    return under(where_largest(from_z, to_z, 8, [&](double z) { return under(z).y; }));
  }

 private:
  CsgBody body_;
  double unit_m_;
};

class HeadCalipers {
 public:
  HeadCalipers(const FetalHead& head, const HeadShape& shape)
      : head_(head),
        shape_(shape),
        unit_m_(shape.unit_m),
        skin_(head.skin, unit_m_),
        skull_(head.skull, unit_m_) {}

  MeasuredHead measure() {
    result_.landmarks = head_.landmarks;
    find_profile();
    find_bones();
    measure_cranium();
    measure_eyes();
    measure_profile();
    measure_widths();
    measure_mandible();
    measure_ears();
    if (shape_.cleft_width > 0) measure_cleft();
    return result_;
  }

  std::vector<NamedPoint> name_points() {
    result_.landmarks = head_.landmarks;
    find_profile();
    find_bones();
    name_profile();
    name_corners();
    return points_;
  }

 private:
  double m(double units) const { return units * unit_m_; }
  void set_mm(FaceMeasure measure, double metres) {
    result_.measures[measure] = metres / kMillimetre;
  }
  void other(std::string_view name, double value) { result_.others.push_back({name, value}); }

  void find_profile();
  void find_bones();
  void measure_cranium();
  void measure_eyes();
  void measure_profile();
  void measure_prenasal();
  void measure_profile_line();
  void measure_prefrontal_space();
  void measure_widths();
  void measure_mandible();
  void measure_ears();
  void measure_cleft();
  void name_profile();
  void name_corners();
  glm::dvec3 nose_tip() const;
  glm::dvec3 mouth_corner(int side) const;
  double bone_length() const;
  // Of the right (+1) or left (-1) side: the point of `body` farthest out between two heights.
  glm::dvec3 widest(const CsgBody& body, double side, double from_y, double to_y, double z) const;
  struct Ear {
    glm::dvec3 top, bottom;
  };
  Ear ear(double side) const;
  void point(std::string_view name, const glm::dvec3& head_m) { points_.push_back({name, head_m}); }

  const FetalHead& head_;
  const HeadShape& shape_;
  double unit_m_;
  Profile skin_, skull_;
  MeasuredHead result_;
  std::vector<NamedPoint> points_;
  glm::dvec3 mentum_{0};  // of the skin
  double fold_ = 0;       // height between lower lip and chin
  glm::dvec3 nasion_{0}, maxilla_{0}, mandible_{0}, gnathion_{0};  // of the bone
};

double degrees(double y, double x) {
  return std::atan2(y, x) / kDegree;
}

void HeadCalipers::find_profile() {
  FetalLandmarks& found = result_.landmarks;
  const double open = m(shape_.open), upper = m(shape_.upper_lip), lower = m(shape_.lower_lip());
  found.nose_tip_m = skin_.foremost(0, m(shape_.subnasale));
  found.subnasale_m = skin_.deepest(found.nose_tip_m.y, upper);
  if (open > 0) {
    found.mouth_m = {0, m(shape_.mouth()) + 0.5 * open, 0};
    found.upper_lip_m = skin_.foremost(found.subnasale_m.y, m(shape_.mouth()) - m(0.2));
  } else {
    found.mouth_m = skin_.deepest(upper, lower);
    found.upper_lip_m = skin_.foremost(found.subnasale_m.y, found.mouth_m.y);
  }
  const double chin = m(2.6 + shape_.chin);
  found.menton_m = skin_.lowest(chin - m(2), chin + m(6), m(shape_.menton + 14));
  fold_ = lower + 0.4 * (found.menton_m.y - lower);
  found.lower_lip_m = skin_.foremost(found.mouth_m.y + 0.5 * open, fold_);
  mentum_ = skin_.largest(
      fold_, found.menton_m.y - m(0.2), [](const glm::dvec3& p) { return p.y - p.z; });
}

void HeadCalipers::find_bones() {
  nasion_ = skull_.at(head_.nasal_root_m.y);
  maxilla_ = skull_.foremost(nasion_.y + m(3), m(shape_.subnasale + 4));
  mandible_ = skull_.foremost(m(shape_.menton - 9), m(shape_.menton - 3));
  gnathion_ = skull_.lowest(mandible_.z, mandible_.z + m(6), m(shape_.menton + 12));
}

void HeadCalipers::measure_cranium() {
  constexpr int kDirections = 120;
  const glm::dvec3 center = head_.landmarks.skull_center_m;
  glm::dvec3 low{1}, high{-1}, first{0}, last{0};
  double around = 0;
  for (int i = 0; i <= kDirections; ++i) {
    const double angle = 2 * kPi * (i % kDirections) / kDirections;
    const glm::dvec3 outwards{std::cos(angle), 0, std::sin(angle)};
    const glm::dvec3 here = first_point(head_.skull, {center + m(50) * outwards, -outwards});
    low = glm::min(low, here);
    high = glm::max(high, here);
    if (i > 0) around += glm::distance(last, here);
    last = here;
  }
  set_mm(FaceMeasure::head_circumference, around);
  const double width = high.x - low.x, length = high.z - low.z;
  result_.measures[FaceMeasure::cephalic_index] = 100 * width / length;
  other("biparietal_mm", width / kMillimetre);
  other("occipitofrontal_mm", length / kMillimetre);
}

void HeadCalipers::measure_eyes() {
  const Ellipsoid &left = head_.eyes[0], &right = head_.eyes[1];
  const double apart = right.center.x - left.center.x, radii = right.radii_m.x + left.radii_m.x;
  set_mm(FaceMeasure::interocular, apart - radii);
  set_mm(FaceMeasure::binocular, apart + radii);
}

void HeadCalipers::measure_profile() {
  const FetalLandmarks& found = result_.landmarks;
  set_mm(FaceMeasure::facial_height, glm::distance(nasion_, gnathion_));
  set_mm(FaceMeasure::philtrum, glm::distance(found.subnasale_m, found.upper_lip_m));
  set_mm(FaceMeasure::chin, glm::distance(found.lower_lip_m, found.menton_m));
  measure_prenasal();
  const glm::dvec3& tip = found.nose_tip_m;
  const auto above = [&](const glm::dvec3& p) { return -degrees(p.z - tip.z, tip.y - p.y); };
  const auto below = [&](const glm::dvec3& p) { return -degrees(p.z - tip.z, p.y - tip.y); };
  result_.measures[FaceMeasure::nasomental_angle] =
      180 + above(skin_.largest(m(-36), m(-5), above)) +
      below(skin_.largest(fold_, found.menton_m.y - m(0.2), below));
  const auto to_mentum = [&](const glm::dvec3& p) {
    return degrees(mentum_.y - p.y, mentum_.z - p.z);
  };
  const glm::dvec3 lip = skin_.largest(
      found.subnasale_m.y + m(1), fold_ - m(1), [&](const glm::dvec3& p) { return -to_mentum(p); });
  result_.measures[FaceMeasure::inferior_facial_angle] = to_mentum(lip);
  const auto forward = [&](const glm::dvec3& p) {
    return degrees(maxilla_.z - p.z, maxilla_.y - p.y);
  };
  result_.measures[FaceMeasure::frontomaxillary_angle] =
      90 - kPalateTilt_deg + forward(skull_.largest(m(-38), nasion_.y - m(3), forward));
  other("maxilla_nasion_mandible_angle_deg",
        degrees(nasion_.z - maxilla_.z, maxilla_.y - nasion_.y) +
            degrees(mandible_.z - nasion_.z, mandible_.y - nasion_.y));
  measure_profile_line();
  measure_prefrontal_space();
  other("upper_facial_height_mm", glm::distance(nasion_, found.subnasale_m) / kMillimetre);
  other("lower_facial_height_mm", glm::distance(found.subnasale_m, found.menton_m) / kMillimetre);
}

// Before the most prominent point of the forehead: from the skin to the line along the fronts of
// mandible and maxilla, over the thickness of the skin.
void HeadCalipers::measure_prefrontal_space() {
  const glm::dvec3 skin = skin_.foremost(m(-30), m(-8)), bone = skull_.at(skin.y);
  const double slope = (mandible_.z - maxilla_.z) / (mandible_.y - maxilla_.y);
  const double line = maxilla_.z + slope * (skin.y - maxilla_.y);
  other("prefrontal_space_ratio", (skin.z - line) / (bone.z - skin.z));
}

// F distance: by which the frontal bone lies before the line from the mandible through the nasion;
// negative behind it (de Jong-Pleij 2012).
void HeadCalipers::measure_profile_line() {
  const glm::dvec3 up = glm::normalize(nasion_ - mandible_);
  const auto before = [&](const glm::dvec3& p) {
    const glm::dvec3 arm = p - nasion_;
    return arm.z * up.y - arm.y * up.z;
  };
  const glm::dvec3 foremost = skull_.largest(m(-34), nasion_.y - m(2), before);
  other("profile_line_distance_mm", before(foremost) / kMillimetre);
}

double HeadCalipers::bone_length() const {
  if (head_.nasal_bone.empty()) return 0;
  // Its ends, along the line of its axis, from outside.
  const Ray axis{head_.nasal_root_m, head_.nasal_along};
  const glm::dvec3 from = first_point(head_.nasal_bone, {axis.at(-m(5)), axis.direction});
  const glm::dvec3 to = first_point(head_.nasal_bone, {axis.at(m(25)), -axis.direction});
  return glm::distance(from, to);
}

void HeadCalipers::measure_prenasal() {
  const CsgBody skin = head_.skin.near({nasion_, m(20)});
  const auto way = [&](double angle) {
    const glm::dvec3 outwards{0, std::sin(angle), -std::cos(angle)};
    return -glm::distance(first_point(skin, {nasion_, outwards}), nasion_);
  };
  const double angle = where_largest(glm::radians(-50.0), glm::radians(60.0), 8, way);
  const double bone = bone_length();
  set_mm(FaceMeasure::nasal_bone, bone);
  other("prenasal_mm", -way(angle) / kMillimetre);
  result_.measures[FaceMeasure::prenasal_ratio] = bone > 0 ? -way(angle) / bone : 0;
}

glm::dvec3 HeadCalipers::widest(
    const CsgBody& body, double side, double from_y, double to_y, double z) const {
  const auto at = [&](double y) {
    return first_point(body, {{side * m(45), y, z}, {-side, 0, 0}});
  };
  return at(where_largest(from_y, to_y, 6, [&](double y) { return side * at(y).x; }));
}

void HeadCalipers::measure_widths() {
  const auto width = [&](const CsgBody& body, double from_y, double to_y, double z) {
    return widest(body, 1, from_y, to_y, z).x - widest(body, -1, from_y, to_y, z).x;
  };
  set_mm(FaceMeasure::zygomatic_width, width(head_.skull, m(4.5), m(8), m(17.5)));
  const FetalLandmarks& found = result_.landmarks;
  set_mm(FaceMeasure::cheek_to_cheek,
         width(head_.skin,
               found.subnasale_m.y - m(2),
               m(shape_.lower_lip()),
               found.subnasale_m.z + m(3)));
}

void HeadCalipers::measure_mandible() {
  double sum = 0;
  for (const double side : {-1.0, 1.0}) {
    const glm::dvec3 angle =
        m(1) * glm::dvec3(side * 12, shape_.menton - 11 - 0.5 * shape_.open, shape_.gonion);
    const glm::dvec3 outwards = glm::normalize(glm::dvec3(side * 0.3, 0.4, 0.85));
    const glm::dvec3 gonion = first_point(head_.skull, {angle + m(8) * outwards, -outwards});
    sum += glm::distance(gonion, mandible_);
  }
  set_mm(FaceMeasure::mandible, sum / 2);
}

HeadCalipers::Ear HeadCalipers::ear(double side) const {
  const double out = shape_.ear * shape_.traits.ear_breadth, size = shape_.ear;
  const double x = shape_.biparietal / 2 + 0.5 + shape_.traits.ear_stands_off,
               y = 2 + shape_.ear_height;
  const CsgBody skin = head_.skin.near({m(1) * glm::dvec3(side * x, y, 32), m(22)});
  const auto extreme = [&](double at_x, double from, double sign) {
    const auto point = [&](double z) {
      return first_point(skin, {{side * m(at_x), m(from), z}, {0, -sign, 0}});
    };
    const auto value = [&](double z) { return sign * point(z).y; };
    return point(where_largest(m(32 - 3 * out), m(32 + 5 * out), 8, value));
  };
  return {extreme(x + 3.7 * out, y - 9 * size - 2, -1),
          extreme(x + 1.3 * out, y + 8 * size + 4, 1)};
}

void HeadCalipers::measure_ears() {
  double length = 0, angle = 0, depth = 0;
  for (const int side : {0, 1}) {
    const Ear found = ear(side == 0 ? -1 : 1);
    length += found.bottom.y - found.top.y;
    const glm::dvec3 eye = head_.eyes[side].center, ear = 0.5 * (found.top + found.bottom);
    angle += degrees(ear.y - eye.y, ear.z - eye.z);
    depth += ear.z - result_.landmarks.subnasale_m.z;
  }
  set_mm(FaceMeasure::ear_length, length / 2);
  other("facial_depth_mm", depth / 2 / kMillimetre);
  result_.measures[FaceMeasure::ear_eye_angle] = angle / 2;
}

// Between the edges of the lip, parallel to x: the narrowest from the front of its farther side to
// 3 units behind.
void HeadCalipers::measure_cleft() {
  constexpr int kSteps = 16;
  const glm::dvec3 middle = m(1) * shape_.cleft();
  const double aside = 0.5 * m(std::max(shape_.cleft_width, shape_.cleft_alveolus) + 2);
  const auto front = [&](double x) {
    return first_point(head_.skin, {{x, middle.y, -m(16)}, {0, 0, 1}}).z;
  };
  const double lip = std::max(front(middle.x - aside), front(middle.x + aside));
  double width = m(20);
  for (int step = 0; step < kSteps; ++step) {
    const glm::dvec3 from{middle.x, middle.y, lip + m(0.2 * step)};
    const glm::dvec3 right = first_point(head_.skin, {from, {1, 0, 0}});
    const glm::dvec3 left = first_point(head_.skin, {from, {-1, 0, 0}});
    width = std::min(width, glm::distance(left, right));
  }
  other("cleft_width_mm", width / kMillimetre);
}

// Asymmetry and a cleft draw it out of the median plane.
glm::dvec3 HeadCalipers::nose_tip() const {
  const CsgBody skin = head_.skin.near({result_.landmarks.nose_tip_m, m(20)});
  const auto at = [&](double x) {
    return first_point(skin, {{x, result_.landmarks.nose_tip_m.y, -m(16)}, {0, 0, 1}});
  };
  return at(where_largest(-m(3), m(3), 12, [&](double x) { return -at(x).z; }));
}

// The end, seen from in front, of the line or opening between the lips. A full cheek covers the
// line's own end. A little within it: the very end lies on the wall of the groove.
glm::dvec3 HeadCalipers::mouth_corner(int side) const {
  const glm::dvec3 end = head_.mouth_corner_m[side];
  const CsgBody skin = head_.skin.near({end, m(24)});
  const double inwards = -std::copysign(m(1), end.x);
  const auto at = [&](double in, double y) {
    return first_point(skin, {{end.x + in * inwards, y, -m(16)}, {0, 0, 1}});
  };
  const auto end_of_row = [&](double y) {
    double in = -1.5;
    while (in < 6 && skin.part_distance(at(in, y)).part != Part::mouth) in += 0.1;
    return in;
  };
  const double row = where_largest(
      end.y - m(2), end.y + m(1 + shape_.open), 15, [&](double y) { return -end_of_row(y); });
  return at(end_of_row(row) + 0.3, row);
}

void HeadCalipers::name_profile() {
  const FetalLandmarks& found = result_.landmarks;
  point("vertex", first_point(head_.skin, {{0, -m(90), found.crown_m.z}, {0, 1, 0}}));
  point("nasion", skin_.at(nasion_.y));
  point("pronasale", nose_tip());
  point("subnasale", found.subnasale_m);
  if (shape_.open == 0) point("stomion", found.mouth_m);
  point("labiale_superius", found.upper_lip_m);
  point("labiale_inferius", found.lower_lip_m);
  point("pogonion",
        skin_.foremost(fold_ + 0.25 * (found.menton_m.y - fold_), found.menton_m.y - m(0.2)));
  point("gnathion", mentum_);
  point("menton", found.menton_m);
}

// Corners of lids (the floors of their grooves) and mouth. Ends of the ears. Left and right are the
// child's: its left is at +x.
void HeadCalipers::name_corners() {
  for (const int side : {0, 1}) {
    const Ear found_ear = ear(side == 0 ? -1 : 1);
    point(side == 0 ? "superaurale_right" : "superaurale_left", found_ear.top);
    point(side == 0 ? "subaurale_right" : "subaurale_left", found_ear.bottom);
    const auto floor = [&](const glm::dvec3& before) {
      return first_point(head_.skin, {before, glm::normalize(head_.eyes[side].center - before)});
    };
    point(side == 0 ? "endocanthion_right" : "endocanthion_left",
          floor(head_.inner_corner_m[side]));
    point(side == 0 ? "exocanthion_right" : "exocanthion_left", floor(head_.outer_corner_m[side]));
    point(side == 0 ? "cheilion_right" : "cheilion_left", mouth_corner(side));
  }
}

}  // namespace

MeasuredHead measure_head(const FetalHead& head, const HeadShape& shape) {
  return HeadCalipers(head, shape).measure();
}

std::vector<NamedPoint> named_points(const FetalHead& head, const HeadShape& shape) {
  return HeadCalipers(head, shape).name_points();
}

}  // namespace wobblebench::phantoms
