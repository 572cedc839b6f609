#include "phantoms/fetal/fetal_head.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <variant>
#include <vector>

#include "base/units.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kSkullThicknessM =
    1.5 * kMillimetre;  // fetal bone and periosteum, as imaged by ultrasound

Shape moved(Shape shape, const glm::dvec3& shift_m) {
  if (auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) {
    ellipsoid->center += shift_m;
    return shape;
  }
  std::vector<TubePoint> points = std::get<Tube>(shape).points();
  for (TubePoint& point : points) point.center += shift_m;
  return Tube(std::move(points));
}

class HeadBuilder {
 public:
  explicit HeadBuilder(const HeadShape& shape)
      : shape_(shape), traits_(shape.traits), open_(shape.open), scale_(shape.unit_m) {}

  FetalHead build() {
    add_cranium();
    add_face();
    add_jaw();
    add_eyes();
    add_nose();
    add_lips();
    add_ears();
    add_skull();
    if (shape_.bossing > 0) add_bossing();
    if (shape_.cleft_width > 0) subtract_cleft();
    add_nasal_bone();
    return head_;
  }

 private:
  double mm(double value) const { return value * scale_; }
  glm::dvec3 at(double x, double y, double z) const { return {mm(x), mm(y), mm(z)}; }
  TubePoint ball(double x, double y, double z, double radius) const {
    return {at(x, y, z), mm(radius)};
  }
  TubePoint ball(const glm::dvec3& center, double radius) const {
    return ball(center.x, center.y, center.z, radius);
  }
  Ellipsoid ellipsoid(const glm::dvec3& center, const glm::dvec3& radii) const {
    return {scale_ * center, scale_ * radii};
  }
  // Right shape as given, left one mirrored, apart from the part's asymmetry.
  std::pair<Shape, Shape> sides(const Shape& shape, PairedPart part) const {
    const glm::dvec3 half_m = 0.5 * shape_.asymmetry[static_cast<std::size_t>(part)];
    return {moved(shape, half_m), mirrored(moved(shape, -half_m))};
  }
  void unite_pair(CsgBody& body, const Shape& shape, double fillet, PairedPart part) const {
    const auto [right, left] = sides(shape, part);
    body.unite(right, mm(fillet));
    body.unite(left, mm(fillet));
  }
  void subtract_pair(CsgBody& body, const Shape& shape, double fillet, PairedPart part) const {
    const auto [right, left] = sides(shape, part);
    body.subtract(right, mm(fillet));
    body.subtract(left, mm(fillet));
  }
  // From the root of the nose to its tip, along the ridge.
  glm::dvec3 ridge(double share) const {
    const glm::dvec3 root{0, -3, 5.6 - shape_.bridge},
        tip{0, shape_.subnasale - 4.2 - traits_.nostril_tilt, -2 - shape_.nose};
    return root + share * (tip - root);
  }

  void add_cranium();
  void add_face();
  void add_jaw();
  void add_eyes();
  void subtract_lid_slit(const Ellipsoid& globe);
  void add_nose();
  void add_lips();
  void add_lower_lip();
  void subtract_mouth();
  void add_tongue();
  void add_bossing();
  void subtract_cleft();
  void add_ears();
  void add_skull();
  void add_face_bones();
  void add_nasal_bone();

  const HeadShape& shape_;
  const FaceTraits& traits_;
  double open_, scale_;
  Ellipsoid cranium_;  // outer surface of the bone
  FetalHead head_;
};

void HeadBuilder::add_cranium() {
  const double width = shape_.biparietal;
  const glm::dvec3 radii{width / 2, 0.52 * width * traits_.crown, shape_.occipitofrontal / 2};
  cranium_ = ellipsoid({0, -0.27 * width, radii.z + 0.8 - shape_.forehead}, radii);
  head_.landmarks.skull_center_m = cranium_.center;
  Ellipsoid scalp = cranium_;
  scalp.radii_m += mm(3.0);
  head_.skin.begin(Part::forehead);
  head_.skin.unite(scalp, 0);
  head_.landmarks.crown_m = scalp.center - glm::dvec3(0, scalp.radii_m.y, 0);
}

void HeadBuilder::add_face() {
  CsgBody& skin = head_.skin;
  const double mouth = shape_.mouth(), side = shape_.zygoma;
  const double chin = shape_.menton - open_;
  skin.begin(Part::face_base);
  skin.unite(ellipsoid({0, 0.33 * chin, 22}, {side + 1.9, 0.7 * chin, 20}), mm(8));
  skin.begin(Part::cheekbone);
  unite_pair(skin, ellipsoid({side - 0.1, -2, 19}, {3.5, 5, 7}), 6, PairedPart::zygoma);
  unite_pair(skin, ellipsoid({side - 2.6, 5.5, 17.5}, {4.4, 5, 7.5}), 6, PairedPart::zygoma);
  skin.begin(Part::cheek);
  unite_pair(skin,
             ellipsoid({shape_.cheek, mouth - 6 - 0.4 * shape_.smile, 11.6 - traits_.cheek_full},
                       {9.8, 9.4, 9.4}),
             7,
             PairedPart::cheek);
  // Muzzle: the rounded base that carries the lips.
  skin.begin(Part::around_mouth);
  skin.unite(ellipsoid({0, mouth - 1.5 + 0.5 * open_, 8}, {9.5, 8.5 + 0.5 * open_, 8}), mm(6));
}

void HeadBuilder::add_jaw() {
  CsgBody& skin = head_.skin;
  const double chin = shape_.menton, back = shape_.chin, angle = shape_.gonion;
  // An open jaw is lowered about its hinge: less, farther back.
  const double behind = chin - 0.5 * open_, middle = chin - 0.2 * open_;
  skin.begin(Part::jaw);
  unite_pair(
      skin,
      Tube{{ball(0.31 * shape_.biparietal, 7, 30, 8), ball(12, behind - 12.5, angle - 3, 6.8)}},
      7,
      PairedPart::jaw);
  unite_pair(skin,
             Tube{{ball(12, behind - 12.5, angle - 3, 6.8), ball(5, middle - 8, 8 + back, 5.2)}},
             6,
             PairedPart::jaw);
  const double tip = 4.6 - 0.5 * traits_.chin_point;
  skin.begin(Part::chin);
  skin.unite(ellipsoid({0, chin - tip, 2.6 + back}, {6.8 * traits_.chin_width, tip, 3.6}), mm(5));
}

void HeadBuilder::add_eyes() {
  const double radius = (shape_.binocular - shape_.interocular) / 4;
  const glm::dvec3 center{
      (shape_.binocular + shape_.interocular) / 4, 0.8, 3.6 + radius + traits_.eye_depth};
  CsgBody& skin = head_.skin;
  const Tube brow{{ball(4, -5.5, 4.5 - traits_.brow, 3),
                   ball(11, -7.5, 5 - traits_.brow, 3),
                   ball(shape_.zygoma + 0.4, -5, 13, 3)}};
  skin.begin(Part::brow);
  unite_pair(skin, brow, 6, PairedPart::brow);
  const glm::dvec3 socket = center - glm::dvec3(0, 0, radius + 4.6);
  skin.begin(Part::eyelids);
  subtract_pair(skin, ellipsoid(socket, {8.5, 6.0, 5.0}), 4, PairedPart::eye);
  unite_pair(skin, ellipsoid(center, glm::dvec3(radius + 1.2)), 1.8, PairedPart::eye);
  const Ellipsoid globe = ellipsoid(center, glm::dvec3(radius));
  subtract_lid_slit(globe);
  const auto [right, left] = sides(globe, PairedPart::eye);
  head_.eyes[1] = std::get<Ellipsoid>(right);
  head_.eyes[0] = std::get<Ellipsoid>(left);
  head_.landmarks.eye_center_m = head_.eyes[1].center;
}

void HeadBuilder::subtract_lid_slit(const Ellipsoid& globe) {
  // Open lids: as deep a groove, and wider.
  const double half = std::max(0.5 * shape_.lids_open, 0.8);
  const double lid = globe.radii_m.x + mm(1.35 + half - 0.8);
  // From the inner to the outer corner of the closed, sagging lids; angles on the lid in degrees.
  const double across[] = {-62, -35, 0, 35, 62}, down[] = {14, 27, 32, 27, 12};
  std::vector<TubePoint> slit;
  for (int i = 0; i < 5; ++i) {
    const double a = glm::radians(across[i]);
    const double sag = std::max(1 - 0.3 * shape_.lids_open, 0.2);
    const double d = sag * glm::radians(down[i]) - std::sin(a) * mm(traits_.eye_slant) / lid;
    const glm::dvec3 direction{std::sin(a) * std::cos(d), std::sin(d), -std::cos(a) * std::cos(d)};
    slit.push_back({globe.center + lid * direction, mm(i == 0 || i == 4 ? 0.35 : half)});
  }
  const Tube groove = smooth_tube(slit, 4);
  subtract_pair(head_.skin, groove, 0.7, PairedPart::eye);
  const auto [right, left] = sides(groove, PairedPart::eye);
  for (const auto& [side, shape] : {std::pair{1, right}, std::pair{0, left}}) {
    const auto& points = std::get<Tube>(shape).points();
    head_.inner_corner_m[side] = points.front().center;
    head_.outer_corner_m[side] = points.back().center;
  }
}

void HeadBuilder::add_nose() {
  CsgBody& skin = head_.skin;
  const double base = shape_.subnasale, tip = base - traits_.nostril_tilt, out = shape_.nose,
               wide = traits_.nose_width;
  // A cleft draws the tip to the other side.
  const double drawn = -0.25 * shape_.cleft_side * shape_.cleft_width;
  const glm::dvec3 aside{
      shape_.asymmetry[static_cast<std::size_t>(PairedPart::nose_tip)].x / scale_ + drawn, 0, 0};
  const glm::dvec3 middle = ridge(0.48) + glm::dvec3(0, 0, 0.45 - traits_.nose_bridge);
  const std::vector<TubePoint> back = {
      ball(ridge(0), 3.2), ball(middle, 2.8), ball(ridge(1) + aside, 2.8)};
  skin.begin(Part::nose);
  skin.unite(smooth_tube(back, 4), mm(3.5));
  skin.unite(ellipsoid(glm::dvec3(0, tip - 2.9, -3.2 - out) + aside, {2.9 * wide, 2.7, 2.7}),
             mm(2.0));
  const double wing = -0.4 - 0.5 * out;
  unite_pair(skin,
             ellipsoid({3.6 * wide, base - 2.1, wing}, {2.5 * wide, 2.3, 2.9}),
             2.0,
             PairedPart::ala);
  const Tube nostril{{ball(2.3 * wide, base + 0.9, -3.0 - 0.7 * out, 0.95),
                      ball(2.1 * wide, base - 1.8, -1.6 - 0.5 * out, 0.8)}};
  subtract_pair(skin, nostril, 0.7, PairedPart::ala);
}

void HeadBuilder::add_lips() {
  CsgBody& skin = head_.skin;
  const double upper = shape_.upper_lip, mouth = shape_.mouth(), base = shape_.subnasale,
               wide = traits_.mouth_width, full = traits_.lip_fullness;
  skin.begin(Part::philtrum);
  skin.subtract(Tube{{ball(0, base + 0.8, -0.4, 1.2), ball(0, upper - 0.7, -2.1, 1.5)}}, mm(1.4));
  // Cupid's bow: the upper lip dips in the middle and falls towards the corners.
  const double up = shape_.smile, aside = 0.5 * shape_.smile;
  const std::vector<TubePoint> bow = {ball(7.4 * wide + aside, mouth + 0.3 - up, 3.4, 1.0),
                                      ball(5.2 * wide, mouth - 1.1 - 0.4 * up, 1.2, 1.6 * full),
                                      ball(2.1, upper - 0.4, -0.4, 1.9 * full),
                                      ball(0, upper + 0.3, -0.5, 1.7 * full)};
  skin.begin(Part::upper_lip);
  unite_pair(skin, smooth_tube(bow, 8), 1.1, PairedPart::mouth);
  add_lower_lip();
  const double pout = 1.5 * (full - 1);  // fuller lips meet farther in front
  const std::vector<TubePoint> line = {ball(7.8 * wide + aside, mouth + 0.7 - up, 2.5, 0.6),
                                       ball(5.2 * wide, mouth + 0.2 - 0.4 * up, 0.1 - pout, 0.6),
                                       ball(2.2, mouth - 0.2, -1.2 - pout, 0.6),
                                       ball(0, mouth + 0.3, -1.4 - pout, 0.6)};
  skin.begin(Part::mouth);
  if (open_ == 0) subtract_pair(skin, smooth_tube(line, 8), 0.8, PairedPart::mouth);
  if (open_ > 0) subtract_mouth();
  const auto [right, left] = sides(Tube{{line.front(), line.back()}}, PairedPart::mouth);
  head_.mouth_corner_m[1] = std::get<Tube>(right).points().front().center;
  head_.mouth_corner_m[0] = std::get<Tube>(left).points().front().center;
}

void HeadBuilder::add_lower_lip() {
  const double mouth = shape_.mouth(), lower = shape_.lower_lip(), wide = traits_.mouth_width,
               full = traits_.lip_fullness, up = shape_.smile, back = 1.1 + 0.1 * shape_.chin;
  const std::vector<TubePoint> roll = {
      ball(7.2 * wide + 0.5 * up, mouth + 1.1 + 0.35 * open_ - up, 3.4, 1.0),
      ball(4.6 * wide, lower - 0.3 - 0.15 * open_ - 0.4 * up, 0.8 + 0.5 * back, 2.0 * full),
      ball(0, lower + 0.1, -0.3 + back, 2.4 * full)};
  head_.skin.begin(Part::lower_lip);
  unite_pair(head_.skin, smooth_tube(roll, 8), 1.0, PairedPart::mouth);
  // Makes the fold under the lower lip shallow.
  const double span = std::max(shape_.menton - lower, 3.0);
  head_.skin.begin(Part::chin);
  head_.skin.unite(ellipsoid({0, lower + 0.5 * span, 5.6 + 2 * back}, {6.5, 0.45 * span, 4.4}),
                   mm(2));
}

// The oral cavity: its front leaves an almond between the lips, its back lies short of the bone.
void HeadBuilder::subtract_mouth() {
  const double mouth = shape_.mouth();
  head_.skin.subtract(ellipsoid({0, mouth + 0.5 * open_, 1}, {7, 0.5 * open_, 8}), mm(0.5));
  if (shape_.tongue > 0) add_tongue();
}

void HeadBuilder::add_tongue() {
  const double thick = std::min(0.3 * open_, 2.6), floor = shape_.mouth() + 0.68 * open_;
  const Tube half{{ball(1.6, floor, 7, thick),
                   ball(1.6, floor, -1, thick),
                   ball(1.2, floor + 0.25 * shape_.tongue, -2.5 - shape_.tongue + thick, thick)}};
  head_.skin.begin(Part::tongue);
  unite_pair(head_.skin, half, 1.5, PairedPart::mouth);
}

void HeadBuilder::add_bossing() {
  const glm::dvec3 radii{15, 11, 11};
  const Ellipsoid bone =
      ellipsoid({0, -16, 0.8 + radii.z - shape_.forehead - shape_.bossing}, radii);
  head_.skull.unite(bone, mm(5));
  Ellipsoid scalp = bone;
  scalp.radii_m += mm(3.0);
  head_.skin.begin(Part::forehead);
  head_.skin.unite(scalp, mm(5));
}

// A groove through the upper lip that narrows towards the nostril; behind it, where the alveolus is
// cleft, a deeper one, and a wider one in the bone.
void HeadBuilder::subtract_cleft() {
  const double radius = 0.5 * shape_.cleft_width, base = shape_.subnasale;
  const glm::dvec3 edge = shape_.cleft();
  const double side = shape_.cleft_side;
  constexpr int kGrooves = 10;
  head_.skin.begin(Part::cleft);
  for (int groove = 0; groove < kGrooves; ++groove) {
    // Full lips reach farther to the front than what is below the nostril.
    const double depth = -2.7 + 0.6 * groove, under_nose = std::max(depth, -1.5) + 0.8;
    head_.skin.subtract(
        Tube{{ball(edge.x, shape_.mouth() + 0.6, depth, 1.05 * radius),
              ball(edge.x, edge.y - 0.5, depth, radius),
              ball(side * 2.4 * traits_.nose_width, base + 0.4, under_nose, 0.45 * radius)}},
        mm(0.5));
  }
  if (shape_.cleft_alveolus <= 0) return;
  const double gap = 0.5 * shape_.cleft_alveolus, middle = shape_.upper_lip;
  head_.skin.subtract(ellipsoid({edge.x, middle, 3}, {gap, 4.5, 7}), mm(0.5));
  head_.skull.subtract(ellipsoid({edge.x, middle, 3}, {gap + 1.2, 6.5, 9}), mm(0.5));
}

void HeadBuilder::add_ears() {
  // Offsets from the side of the scalp, of an ear of 18 mm.
  const double size = shape_.ear, out = size * traits_.ear_breadth;
  const glm::dvec3 anchor{
      shape_.biparietal / 2 + 0.5 + traits_.ear_stands_off, 2 + shape_.ear_height, 32};
  const auto offset = [&](double x, double y, double z, double radius) {
    return ball(anchor + glm::dvec3(out * x, size * y, out * z), size * radius);
  };
  CsgBody& skin = head_.skin;
  const std::vector<TubePoint> helix = {offset(-2.5, 7.5, -2, 1.6),
                                        offset(1.3, 6.0, 0, 1.8),
                                        offset(3.1, 1.0, 3, 1.5),
                                        offset(4.1, -4.5, 4, 1.4),
                                        offset(3.3, -7.5, 1, 1.4),
                                        offset(1.5, -6.5, -2, 1.3),
                                        offset(0.5, -3.0, -3, 1.3)};
  skin.begin(Part::ear);
  unite_pair(skin, Tube{{offset(-0.5, 4, -1, 2.2), offset(1.3, -3, 1.5, 2.6)}}, 2, PairedPart::ear);
  unite_pair(skin, smooth_tube(helix, 3), 1.0, PairedPart::ear);
}

void HeadBuilder::add_skull() {
  CsgBody& skull = head_.skull;
  skull.unite(cranium_, 0);
  add_face_bones();
  Ellipsoid within = cranium_;
  within.radii_m -= kSkullThicknessM;
  head_.brain.unite(within, 0);
  for (Ellipsoid orbit : head_.eyes) {
    skull.subtract(orbit, mm(0.5));
    orbit.radii_m += kSkullThicknessM;
    head_.brain.subtract(orbit, mm(0.5));
  }
}

// They meet the braincase below the BPD/OFD plane.
void HeadBuilder::add_face_bones() {
  CsgBody& skull = head_.skull;
  const double chin = shape_.menton, back = shape_.chin, angle = shape_.gonion,
               side = shape_.zygoma;
  const double behind = chin - 0.5 * open_, front = chin - 0.1 * open_;
  skull.unite(ellipsoid({0, shape_.subnasale - 1, 17.5}, {13, 9, 14.5}), mm(3));
  // Where frontal and nasal bone meet.
  skull.unite(ellipsoid({0, -1.5, 10.2 - shape_.bone_bridge}, {5, 5, 6}), mm(2));
  unite_pair(skull, ellipsoid({side - 3, 6, 17.5}, {3, 2.5, 6}), 2, PairedPart::zygoma);
  unite_pair(skull,
             Tube{{ball(0.29 * shape_.biparietal, 6, 30, 2.5), ball(12, behind - 11, angle, 2.6)}},
             3,
             PairedPart::jaw);
  unite_pair(skull,
             Tube{{ball(12, behind - 11, angle, 2.6), ball(0, front - 5.4, 9.0 + back, 2.6)}},
             3,
             PairedPart::jaw);
}

void HeadBuilder::add_nasal_bone() {
  constexpr double kRadius = 0.55, kRoot = 0.12;
  const double core = shape_.nasal_bone - 2 * kRadius;  // between the centres of its round ends
  const glm::dvec3 along = glm::normalize(ridge(1) - ridge(0)), root = ridge(kRoot);
  head_.nasal_root_m = scale_ * root;
  head_.nasal_along = along;
  if (core <= 0) return;
  head_.nasal_bone.unite(
      Tube{{ball(root + kRadius * along, kRadius), ball(root + (kRadius + core) * along, kRadius)}},
      0);
}

}  // namespace

glm::dvec3 HeadShape::cleft() const {
  return {cleft_side * 2.6, upper_lip + 0.6, -1.0};
}

FetalHead build_head(const HeadShape& shape) {
  return HeadBuilder(shape).build();
}

}  // namespace wobblebench::phantoms
