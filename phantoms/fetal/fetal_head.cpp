#include "phantoms/fetal/fetal_head.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "base/parallel.h"
#include "base/units.h"

namespace wobblebench::phantoms {
namespace {

double second_diameter(double perimeter, double diameter) {
  double low = diameter, high = perimeter;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (ellipse_perimeter(diameter, middle) < perimeter ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

constexpr double kSkullThicknessM =
    1.5 * kMillimetre;  // fetal bone and periosteum, as imaged by ultrasound

// The lips of the 21-week face, below the tip of the upper lip.
constexpr double kMouthM = 2.1 * kMillimetre, kLowerLipM = 4.4 * kMillimetre;

// Heights of the mid-line features, metres below the origin; `mouth`: of the upper lip's edge.
struct FaceHeights {
  double subnasale, upper_lip, mouth, lower_lip, menton;
  double open;  // gap between the lips, by which lower lip and chin are lowered
};

// Builds the head from shapes in millimetres of the 21-week face, scaled to the age.
class HeadBuilder {
 public:
  HeadBuilder(const FetalBiometry& biometry, const FaceHeights& heights)
      : biometry_(biometry),
        scale_(biometry.binocular_m / fetal_biometry(21).binocular_m),
        heights_(heights) {}

  FetalHead build() {
    add_cranium();
    add_face();
    add_eyes();
    add_nose();
    add_lips();
    add_ears();
    add_skull();
    return head_;
  }

 private:
  double mm(double value) const { return value * kMillimetre * scale_; }
  glm::dvec3 at(double x, double y, double z) const { return {mm(x), mm(y), mm(z)}; }
  TubePoint ball(double x, double y, double z, double radius) const {
    return {at(x, y, z), mm(radius)};
  }
  Ellipsoid ellipsoid(glm::dvec3 center, glm::dvec3 radii) const {
    return {mm(1) * center, mm(1) * radii};
  }
  // A height in metres, in the units of at().
  double height(double metres) const { return metres / mm(1); }

  void add_cranium();
  void add_face();
  void add_eyes();
  void subtract_lid_slit();
  void add_nose();
  void add_lips();
  void subtract_mouth();
  void add_ears();
  void add_skull();

  const FetalBiometry& biometry_;
  double scale_;
  FaceHeights heights_;
  Ellipsoid cranium_;  // outer surface of the bone
  FetalHead head_;
};

void HeadBuilder::add_cranium() {
  const glm::dvec3 radii{
      biometry_.biparietal_m / 2, 0.52 * biometry_.biparietal_m, biometry_.occipitofrontal_m / 2};
  cranium_ = {{0, -0.27 * biometry_.biparietal_m, radii.z + mm(0.8)}, radii};
  head_.landmarks.skull_center_m = cranium_.center;
  Ellipsoid scalp = cranium_;
  scalp.radii_m += mm(3.0);
  head_.skin.unite(scalp, 0);
  head_.landmarks.crown_m = scalp.center - glm::dvec3(0, scalp.radii_m.y, 0);
}

void HeadBuilder::add_face() {
  CsgBody& skin = head_.skin;
  const double chin = height(heights_.menton), mouth = height(heights_.mouth),
               open = height(heights_.open);
  skin.unite(ellipsoid({0, 9, 22}, {20.5, 20, 20}), mm(8));
  // An open jaw is lowered about its hinge: less, farther back.
  const double back = chin - 0.5 * open, middle = chin - 0.2 * open;
  skin.unite_pair(Tube{{ball(16, 9, 30, 8), ball(10.5, back - 13, 17, 7)}}, mm(7));
  skin.unite_pair(Tube{{ball(10.5, back - 13, 17, 7), ball(5, middle - 8.5, 9, 5.5)}}, mm(6));
  skin.unite_pair(ellipsoid({18.5, -2, 19}, {3.5, 5, 7}), mm(6));
  skin.unite_pair(ellipsoid({13.6, mouth - 6, 11.6}, {9.8, 9.4, 9.4}), mm(7));
  // Muzzle: the rounded base that carries the lips.
  skin.unite(ellipsoid({0, mouth - 1.5 + 0.5 * open, 8}, {9.5, 8.5 + 0.5 * open, 8}), mm(6));
  skin.unite(ellipsoid({0, chin - 4.7, 3.4}, {6.8, 4.7, 4.4}), mm(5));
}

void HeadBuilder::add_eyes() {
  const double radius = (biometry_.binocular_m - biometry_.interocular_m) / 4;
  const glm::dvec3 center{
      (biometry_.binocular_m + biometry_.interocular_m) / 4, mm(0.8), mm(3.6) + radius};
  head_.landmarks.eye_center_m = center;
  head_.eyes[1] = {center, glm::dvec3(radius)};
  head_.eyes[0] = {center * glm::dvec3(-1, 1, 1), glm::dvec3(radius)};
  CsgBody& skin = head_.skin;
  skin.unite_pair(Tube{{ball(4, -5.5, 4, 3), ball(11, -7.5, 4.5, 3), ball(19, -5, 13, 3)}}, mm(6));
  skin.subtract_pair(Ellipsoid{center - glm::dvec3(0, 0, radius + mm(4.6)), at(8.5, 6.0, 5.0)},
                     mm(4));
  skin.unite_pair(Ellipsoid{center, glm::dvec3(radius + mm(1.2))}, mm(1.8));
  subtract_lid_slit();
}

void HeadBuilder::subtract_lid_slit() {
  const glm::dvec3 center = head_.eyes[1].center;
  const double lid = head_.eyes[1].radii_m.x + mm(1.35);
  // From the inner to the outer corner of the closed, sagging lids; angles on the lid in degrees.
  const double across[] = {-62, -35, 0, 35, 62}, down[] = {14, 27, 32, 27, 12};
  std::vector<TubePoint> slit;
  for (int i = 0; i < 5; ++i) {
    const double a = glm::radians(across[i]), d = glm::radians(down[i]);
    const glm::dvec3 direction{std::sin(a) * std::cos(d), std::sin(d), -std::cos(a) * std::cos(d)};
    slit.push_back({center + lid * direction, mm(i == 0 || i == 4 ? 0.35 : 0.8)});
  }
  head_.skin.subtract_pair(smooth_tube(slit, 4), mm(0.7));
}

void HeadBuilder::add_nose() {
  CsgBody& skin = head_.skin;
  const double base = height(heights_.subnasale);
  const std::vector<TubePoint> ridge = {
      ball(0, -3, 5.2, 3.2), ball(0, 2, 2.2, 2.8), ball(0, base - 4.2, -2.0, 2.8)};
  skin.unite(smooth_tube(ridge, 4), mm(3.5));
  skin.unite(ellipsoid({0, base - 2.9, -3.2}, {2.9, 2.7, 2.7}), mm(2.0));
  skin.unite_pair(ellipsoid({3.6, base - 2.1, -0.4}, {2.5, 2.3, 2.9}), mm(2.0));
  skin.subtract_pair(Tube{{ball(2.3, base + 0.9, -3.0, 0.95), ball(2.1, base - 1.8, -1.6, 0.8)}},
                     mm(0.7));
}

void HeadBuilder::add_lips() {
  CsgBody& skin = head_.skin;
  const double upper = height(heights_.upper_lip), mouth = height(heights_.mouth),
               lower = height(heights_.lower_lip), base = height(heights_.subnasale),
               open = height(heights_.open);
  skin.subtract(Tube{{ball(0, base + 0.8, -0.4, 1.2), ball(0, upper - 0.7, -2.1, 1.5)}}, mm(1.4));
  // Cupid's bow: the upper lip dips in the middle and falls towards the corners.
  const std::vector<TubePoint> bow = {ball(7.4, mouth + 0.3, 3.4, 1.0),
                                      ball(5.2, mouth - 1.1, 1.2, 1.6),
                                      ball(2.1, upper - 0.4, -0.4, 1.9),
                                      ball(0, upper + 0.3, -0.5, 1.7)};
  skin.unite_pair(smooth_tube(bow, 8), mm(1.1));
  const std::vector<TubePoint> roll = {ball(7.2, mouth + 1.1 + 0.35 * open, 3.4, 1.0),
                                       ball(4.6, lower - 0.3 - 0.15 * open, 0.8, 2.0),
                                       ball(0, lower + 0.1, -0.3, 2.4)};
  skin.unite_pair(smooth_tube(roll, 8), mm(1.0));
  const std::vector<TubePoint> line = {ball(7.8, mouth + 0.7, 2.5, 0.6),
                                       ball(5.2, mouth + 0.2, 0.1, 0.6),
                                       ball(2.2, mouth - 0.2, -1.2, 0.6),
                                       ball(0, mouth + 0.3, -1.4, 0.6)};
  if (open == 0) skin.subtract_pair(smooth_tube(line, 8), mm(0.8));
  // Makes the fold under the lower lip shallow.
  skin.unite(ellipsoid({0, lower + 4.0, 5.6}, {6.5, 3.6, 4.4}), mm(2));
  if (open > 0) subtract_mouth();
}

// The oral cavity: its front leaves an almond between the lips, its back lies short of the bone.
void HeadBuilder::subtract_mouth() {
  const double mouth = height(heights_.mouth), open = height(heights_.open);
  head_.skin.subtract(ellipsoid({0, mouth + 0.5 * open, 1}, {7, 0.5 * open, 8}), mm(0.5));
}

void HeadBuilder::add_ears() {
  const double side = biometry_.biparietal_m / 2 / mm(1);
  CsgBody& skin = head_.skin;
  const std::vector<TubePoint> helix = {ball(side - 2.0, 9.5, 30, 1.6),
                                        ball(side + 1.8, 8.0, 32, 1.8),
                                        ball(side + 3.6, 3.0, 35, 1.5),
                                        ball(side + 4.6, -2.5, 36, 1.4),
                                        ball(side + 3.8, -5.5, 33, 1.4),
                                        ball(side + 2.0, -4.5, 30, 1.3),
                                        ball(side + 1.0, -1.0, 29, 1.3)};
  skin.unite_pair(Tube{{ball(side, 6, 31, 2.2), ball(side + 1.8, -1, 33.5, 2.6)}}, mm(2));
  skin.unite_pair(smooth_tube(helix, 3), mm(1.0));
}

void HeadBuilder::add_skull() {
  CsgBody& skull = head_.skull;
  skull.unite(cranium_, 0);
  const double chin = height(heights_.menton), open = height(heights_.open);
  const double back = chin - 0.5 * open, front = chin - 0.1 * open;
  // The facial bones meet the braincase below the BPD/OFD plane.
  skull.unite(ellipsoid({0, 9, 21}, {17, 14, 15}), mm(3));
  skull.unite_pair(Tube{{ball(15, 8, 30, 3), ball(9, back - 11, 15, 3)}}, mm(3));
  skull.unite_pair(Tube{{ball(9, back - 11, 15, 3), ball(0, front - 6, 8, 2.6)}}, mm(3));
  Ellipsoid within = cranium_;
  within.radii_m -= kSkullThicknessM;
  head_.brain.unite(within, 0);
  for (Ellipsoid orbit : head_.eyes) {
    skull.subtract(orbit, mm(0.5));
    orbit.radii_m += kSkullThicknessM;
    head_.brain.subtract(orbit, mm(0.5));
  }
}

// The profile of the skin in the median plane.
class Profile {
 public:
  explicit Profile(const CsgBody& skin) : skin_(skin) {}

  // z at which a ray along +z at height y meets the skin, by sphere tracing.
  double depth(double y) const {
    double z = -20 * kMillimetre;
    for (int step = 0; step < 200; ++step) {
      const double gap = skin_.distance({0, y, z});
      if (gap < 1e-7 || z > 50 * kMillimetre) break;
      z += 0.8 * gap;
    }
    return z;
  }

  // Point of extreme z between two heights; sign +1: deepest, -1: most prominent.
  glm::dvec3 extreme(double from, double to, double sign) const {
    constexpr int kSteps = 120;
    std::array<glm::dvec3, kSteps + 1> found;
    parallel_rows(kSteps + 1, [&](int step) {
      const double y = from + (to - from) * step / kSteps;
      found[step] = {0, y, depth(y)};
    });
    glm::dvec3 best = found[0];
    for (const glm::dvec3& point : found) {
      if (sign * (point.z - best.z) > 0) best = point;
    }
    return best;
  }

  // Lowest point of the chin, at most `reach` behind `front`.
  glm::dvec3 lowest(const glm::dvec3& front, double reach) const {
    glm::dvec3 best = front;
    for (int step = 0; step <= 60; ++step) {
      glm::dvec3 below{0, front.y + 20 * kMillimetre, front.z + reach * step / 60};
      for (int move = 0; move < 200; ++move) {
        const double gap = skin_.distance(below);
        if (gap < 1e-7) break;
        below.y -= 0.8 * gap;
      }
      if (below.y > best.y) best = below;
    }
    return best;
  }

 private:
  const CsgBody& skin_;
};

void find_landmarks(const CsgBody& skin, const FaceHeights& heights, FetalLandmarks& found) {
  const Profile profile(skin);
  found.nose_tip_m = profile.extreme(0, heights.subnasale, -1);
  found.subnasale_m = profile.extreme(found.nose_tip_m.y, heights.upper_lip, +1);
  found.mouth_m = profile.extreme(heights.upper_lip, heights.lower_lip - heights.open, +1);
  found.upper_lip_m = profile.extreme(found.subnasale_m.y, found.mouth_m.y, -1);
  const double fold = 0.5 * (heights.lower_lip + heights.menton);
  found.lower_lip_m = profile.extreme(found.mouth_m.y + heights.open, fold, -1);
  const glm::dvec3 chin = profile.extreme(fold, heights.menton - 2 * kMillimetre, -1);
  found.menton_m = profile.lowest(chin, 7 * kMillimetre);
}

// The same face with its lower jaw lowered.
FetalHead opened(const FetalBiometry& biometry,
                 FaceHeights heights,
                 double open_m,
                 const FetalLandmarks& closed) {
  heights.open = open_m;
  heights.lower_lip += open_m;
  heights.menton += open_m;
  FetalHead head = HeadBuilder(biometry, heights).build();
  FetalLandmarks& found = head.landmarks;
  find_landmarks(head.skin, heights, found);
  found.upper_lip_m = closed.upper_lip_m;
  found.mouth_m = closed.mouth_m + glm::dvec3(0, 0.5 * open_m, 0);
  return head;
}

}  // namespace

double ellipse_perimeter(double diameter_a, double diameter_b) {
  const double difference = diameter_a - diameter_b, sum = diameter_a + diameter_b;
  const double h = difference * difference / (sum * sum);
  return kPi / 2 * sum * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)));
}

FetalBiometry fetal_biometry(double gestational_age_weeks) {
  const double g = gestational_age_weeks, g2 = g * g;
  FetalBiometry b{};
  b.head_around_m = kMillimetre * (-28.2849 + 1.69267 * g2 - 0.397485 * g2 * std::log(g));
  b.biparietal_m = kMillimetre * (5.60878 + 0.158369 * g2 - 0.00256379 * g2 * g);
  b.occipitofrontal_m = second_diameter(b.head_around_m, b.biparietal_m);
  b.interocular_m = kMillimetre * (2.304 + 0.510 * g);
  b.binocular_m = kMillimetre * (2.590 + 1.420 * g);
  b.philtrum_m = kMillimetre * std::exp(2.778577 - 23.476723 / g);
  b.chin_m = kMillimetre * std::exp(3.7922 - 28.043 / g);
  return b;
}

FetalHead make_head(const FetalBiometry& biometry, double mouth_open_m) {
  const double scale = biometry.binocular_m / fetal_biometry(21).binocular_m;
  FaceHeights heights{};
  heights.subnasale = 11.6 * kMillimetre * scale;
  heights.upper_lip = heights.subnasale + biometry.philtrum_m;
  heights.menton = heights.upper_lip + kLowerLipM * scale + biometry.chin_m;
  // Fillets shift the extremes of the profile: each round corrects the heights by the measured
  // error.
  constexpr int kRounds = 12;
  for (int round = 0;; ++round) {
    heights.mouth = heights.upper_lip + kMouthM * scale;
    heights.lower_lip = heights.upper_lip + kLowerLipM * scale;
    FetalHead head = HeadBuilder(biometry, heights).build();
    FetalLandmarks& found = head.landmarks;
    find_landmarks(head.skin, heights, found);
    if (round == kRounds) {
      return mouth_open_m == 0 ? head : opened(biometry, heights, mouth_open_m, found);
    }
    heights.upper_lip += biometry.philtrum_m - glm::distance(found.subnasale_m, found.upper_lip_m);
    heights.menton += biometry.chin_m - glm::distance(found.lower_lip_m, found.menton_m);
  }
}

}  // namespace wobblebench::phantoms
