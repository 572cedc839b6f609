// The fetal face phantom: the head, what lies about it, and the mother's tissue in front.
#include <algorithm>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <memory>

#include "phantoms/builders.h"
#include "phantoms/fetal_head.h"
#include "phantoms/fetal_surroundings.h"
#include "phantoms/grids.h"
#include "phantoms/level_set.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kMm = 1e-3;

double face_scale(const FetalBiometry& biometry) {
  return biometry.binocular_m / fetal_biometry(21).binocular_m;
}

FetalHead posed_head(double weeks) {
  const FetalBiometry biometry = fetal_biometry(weeks);
  FetalHead head = sculpt_head(biometry);
  // A fetus seldom faces the probe squarely.
  head.landmarks.head_to_phantom =
      rotation_xyz({glm::radians(-4.0), glm::radians(8.0), glm::radians(-5.0)});
  head.landmarks.head_position_m = face_scale(biometry) * kMm * glm::dvec3(0, -5, 2);
  return head;
}

// Everything that is looked at, as signed distances in the phantom frame.
class FetalScene {
 public:
  explicit FetalScene(double weeks)
      : scale_(face_scale(fetal_biometry(weeks))),
        head_(posed_head(weeks)),
        to_head_(glm::transpose(head_.landmarks.head_to_phantom)),
        body_(sculpt_body(scale_)),
        hand_(sculpt_hand(scale_)),
        cord_(scale_) {}

  double cavity(const glm::dvec3& p) const { return cavity_distance(p, scale_); }
  double cord(const glm::dvec3& p) const { return cord_.distance(p); }
  double skin(const glm::dvec3& p) const {
    const double trunk =
        smooth_union(head_.skin.distance(in_head(p)), body_.distance(p), 5 * kMm * scale_);
    return smooth_union(trunk, hand_.distance(p), 1 * kMm * scale_);
  }
  double skull(const glm::dvec3& p) const { return head_.skull.distance(in_head(p)); }
  double brain(const glm::dvec3& p) const { return head_.brain.distance(in_head(p)); }
  double eyes(const glm::dvec3& p) const {
    const glm::dvec3 q = in_head(p);
    return std::min(head_.eyes[0].distance(q), head_.eyes[1].distance(q));
  }

  /// Holds the cavity, and so all the rest.
  Box bounds() const {
    const CavitySize size = cavity_size(scale_);
    return {size.center_m - 1.15 * size.radii_m, size.center_m + 1.15 * size.radii_m};
  }
  /// From the fluid before the nose to behind the ears, from above the crown to the upper chest.
  Box region_of_interest() const {
    const double crown = head_.landmarks.crown_m.y + head_.landmarks.head_position_m.y;
    return {{-40 * kMm * scale_, crown - 3 * kMm, -18 * kMm * scale_},
            scale_ * kMm * glm::dvec3(40, 43, 42)};
  }
  /// The face some 60 mm before the probe, the head in the middle of the sweep; an older and so
  /// larger fetus lies deeper, which keeps the mother's tissue in front between 20 and 33 mm.
  glm::dvec3 suggested_position_m() const {
    return {0, 6 * kMm * scale_, 105 * kMm + 20 * kMm * (scale_ - 1)};
  }

 private:
  glm::dvec3 in_head(const glm::dvec3& p) const {
    return to_head_ * (p - head_.landmarks.head_position_m);
  }

  double scale_;  // of the face against that of 21 weeks
  FetalHead head_;
  glm::dmat3 to_head_;
  Sculpture body_, hand_;
  UmbilicalCord cord_;
};

struct Part {
  const char* name;
  const char* inside;
  bool is_target;
  double (FetalScene::*distance)(const glm::dvec3&) const;
  Distances distances;
};

// In painter's order.
constexpr Part kParts[] = {
    {"cavity", "amniotic_fluid", true, &FetalScene::cavity, Distances::exact},
    {"cord", "umbilical_cord", true, &FetalScene::cord, Distances::first_order},
    {"skin", "fetal_skin", true, &FetalScene::skin, Distances::first_order},
    {"skull", "fetal_skull", false, &FetalScene::skull, Distances::first_order},
    {"brain", "brain", false, &FetalScene::brain, Distances::first_order},
    {"eyes", "vitreous", false, &FetalScene::eyes, Distances::exact}};

}  // namespace

FetalLandmarks fetal_landmarks(double gestational_age_weeks) {
  return posed_head(gestational_age_weeks).landmarks;
}

Phantom make_fetal_face(const PhantomOptions& options) {
  const FetalScene scene(options.gestational_age_weeks);
  std::vector<Surface> surfaces;
  auto grids = std::make_shared<Grids>();
  for (const Part& part : kParts) {
    surfaces.push_back({part.name, material_index(part.inside), part.is_target});
    const auto distance = [&](const glm::dvec3& p) { return (scene.*part.distance)(p); };
    grids->signed_distance.push_back(
        build_level_set(part.name, distance, scene.bounds(), options.voxel_m, part.distances));
  }
  return Phantom("fetal_face",
                 material_table(),
                 material_index("uterus_wall"),
                 surfaces,
                 scene.region_of_interest(),
                 scene.suggested_position_m(),
                 grids);
}

}  // namespace wobblebench::phantoms
