#include "phantoms/fetal/face_features.h"

#include "base/units.h"

namespace wobblebench::phantoms {
namespace {

/// Places balls of the head frame in the phantom frame.
class Placer {
 public:
  Placer(const FetalLandmarks& pose, double scale) : pose_(pose), scale_(scale) {}

  double mm(double value) const { return value * kMillimetre * scale_; }
  glm::dvec3 at(double x, double y, double z) const { return {mm(x), mm(y), mm(z)}; }
  FeatureBall ball(const glm::dvec3& head_m, double radius_m) const {
    return {pose_.head_to_phantom * head_m + pose_.head_position_m, radius_m};
  }
  void pair(glm::dvec3 head_m, double radius_m, std::vector<FeatureBall>& balls) const {
    balls.push_back(ball(head_m, radius_m));
    head_m.x = -head_m.x;
    balls.push_back(ball(head_m, radius_m));
  }

 private:
  const FetalLandmarks& pose_;
  double scale_;
};

}  // namespace

std::vector<Feature> face_features(const FetalHead& head,
                                   const FetalBiometry& biometry,
                                   double scale,
                                   double mouth_open_m) {
  const FetalLandmarks& face = head.landmarks;
  const Placer place(face, scale);
  const double mouth = face.mouth_m.y, base = face.subnasale_m.y;
  Feature nose{
      "nose",
      {place.ball(face.nose_tip_m, place.mm(5.5)), place.ball(place.at(0, 2, 2.2), place.mm(4.5))}};
  place.pair({place.mm(3.6), base - place.mm(2.1), 0}, place.mm(4), nose.balls);
  const double lip = 0.5 * mouth_open_m;
  Feature lips{"lips", {place.ball(face.mouth_m, place.mm(5.5) + lip)}};
  place.pair({place.mm(4.8), mouth, place.mm(1.2)}, place.mm(4.5) + lip, lips.balls);
  Feature eyelids{"eyelids", {}};
  place.pair(face.eye_center_m, head.eyes[1].radii_m.x + place.mm(3), eyelids.balls);
  Feature ears{"ears", {}};
  place.pair({biometry.biparietal_m / 2 + place.mm(2.5), place.mm(2), place.mm(33)},
             place.mm(9),
             ears.balls);
  Feature cheeks{"cheeks", {}};
  place.pair({place.mm(15), mouth - lip - place.mm(6), place.mm(11)}, place.mm(12), cheeks.balls);
  Feature forehead{"forehead", {place.ball(place.at(0, -17, 4), place.mm(11))}};
  place.pair(place.at(13, -16, 9), place.mm(10), forehead.balls);
  return {nose, lips, eyelids, ears, cheeks, forehead};
}

}  // namespace wobblebench::phantoms
