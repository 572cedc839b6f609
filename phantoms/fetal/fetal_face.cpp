// The fetal_face phantom: head, body, hand, cord, amniotic cavity, and maternal tissue in front.
#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/number_text.h"
#include "base/parallel.h"
#include "base/units.h"
#include "phantoms/builders.h"
#include "phantoms/fetal/fetal_child.h"
#include "phantoms/fetal/fetal_head.h"
#include "phantoms/fetal/fetal_surroundings.h"
#include "phantoms/fetal/head_extent.h"
#include "phantoms/grids.h"
#include "phantoms/label_finder.h"
#include "phantoms/refusal.h"
#include "phantoms/shapes/level_set.h"
#include "phantoms/truth.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kFaceOfProbe_m = 40 * kMillimetre;    // z in the default probe's frame
constexpr double kThinnestUterus_m = 5 * kMillimetre;  // of its wall on the axis; assumed
constexpr double kTrunkFillet_m = 5 * kMillimetre;     // between head and body at 21 weeks
// At 21 weeks, to the sides: short of the hand. Assumed.
constexpr double kJawReach_m = 16 * kMillimetre;

// Size of the mean face of this age against that of 21 weeks: the child's surroundings are of this
// size, whatever the child's own.
double scale_of_age(double weeks) {
  return face_unit_m(mean_face(weeks)) / kMillimetre;
}

// z of the cavity's front wall on the line along z through (x, y), by bisection.
double cavity_front_m(double scale, double x, double y) {
  const CavitySize size = cavity_size(scale);
  double outside = size.center_m.z - 1.5 * size.radii_m.z, inside = size.center_m.z;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (outside + inside);
    (cavity_distance({x, y, middle}, scale) < 0 ? inside : outside) = middle;
  }
  return outside;
}

// The face some 60 mm in front of the probe, the head in the middle of the sweep; an older, larger
// fetus lies deeper, so that the fluid begins at 23 to 29 mm (mean 29 mm, at least 17 mm: Carson
// 1989); deeper still where the maternal layer is thicker.
glm::dvec3 position_for(double scale, double maternal_layer_m) {
  const double y = 6 * kMillimetre * scale,
               usual_z = 105 * kMillimetre + 20 * kMillimetre * (scale - 1);
  const double room = maternal_layer_m > 0 ? maternal_layer_m + kThinnestUterus_m : 0;
  return {0, y, std::max(usual_z, kFaceOfProbe_m + room - cavity_front_m(scale, 0, -y))};
}

// Signed distances of all parts, in the phantom frame. Must outlive the functions that it gives.
class FetalScene {
 public:
  explicit FetalScene(const PhantomOptions& options)
      : child_(make_child(options)),
        head_(child_.solved.head),
        scale_(scale_of_age(options.gestational_age_weeks)),
        mouth_open_m_(options.mouth_open_m),
        to_head_(glm::transpose(head_.landmarks.head_to_phantom)),
        body_(make_body(scale_)),
        hand_(make_hand(scale_)),
        hand_is_before_(options.hand == HandPlace::before),
        cord_(make_cord(options)),
        placenta_m_(options.placenta_m),
        skin_(posed_skin()),
        position_m_(position_for(scale_, options.maternal_layer_m)),
        maternal_layer_(options.maternal_layer_m, glm::dvec3(0, 0, kFaceOfProbe_m) - position_m_) {
    if (hand_is_before_) hand_ = place_hand(options);
    check_placenta(options);
  }

  // Each part's distances within a ball.
  DistanceFunction muscle(const Ball&) const {
    return [this](const glm::dvec3& p) { return maternal_layer_.muscle(p); };
  }
  DistanceFunction fat(const Ball&) const {
    return [this](const glm::dvec3& p) { return maternal_layer_.fat(p); };
  }
  DistanceFunction maternal_skin(const Ball&) const {
    return [this](const glm::dvec3& p) { return maternal_layer_.skin(p); };
  }
  DistanceFunction cavity(const Ball&) const {
    return [this](const glm::dvec3& p) { return cavity_distance(p, scale_); };
  }
  DistanceFunction cord(const Ball& ball) const {
    return [cord = cord_.near(ball)](const glm::dvec3& p) { return cord.distance(p); };
  }
  DistanceFunction skin(const Ball& ball) const {
    return [this,
            head = head_.skin.near(in_head(ball)),
            body = body_.near(ball),
            hand = hand_.near(ball)](const glm::dvec3& p) {
      const double trunk =
          smooth_union(head.distance(in_head(p)), body.distance(p), kTrunkFillet_m * scale_);
      if (hand_is_before_) return trunk;
      return smooth_union(trunk, hand.distance(p), 1 * kMillimetre * scale_);
    };
  }
  /// A hand before the face.
  DistanceFunction hand(const Ball& ball) const {
    return [hand = hand_.near(ball)](const glm::dvec3& p) { return hand.distance(p); };
  }
  DistanceFunction placenta(const Ball&) const {
    return [this](const glm::dvec3& p) { return placenta_distance(p, scale_, placenta_m_); };
  }
  DistanceFunction skull(const Ball& ball) const {
    return [this, skull = head_.skull.near(in_head(ball))](const glm::dvec3& p) {
      const glm::dvec3 q = in_head(p);
      const double bone = skull.distance(q);
      return head_.nasal_bone.empty() ? bone : std::min(bone, head_.nasal_bone.distance(q));
    };
  }
  DistanceFunction brain(const Ball& ball) const {
    return [this, brain = head_.brain.near(in_head(ball))](const glm::dvec3& p) {
      return brain.distance(in_head(p));
    };
  }
  DistanceFunction eyes(const Ball&) const {
    return [this](const glm::dvec3& p) {
      const glm::dvec3 q = in_head(p);
      return std::min(head_.eyes[0].distance(q), head_.eyes[1].distance(q));
    };
  }

  /// Contains the cavity, and so all that lies in it.
  Box cavity_bounds() const {
    const CavitySize size = cavity_size(scale_);
    return {size.center_m - 1.15 * size.radii_m, size.center_m + 1.15 * size.radii_m};
  }
  Box maternal_bounds() const { return maternal_layer_.bounds(); }
  /// Reaches from the fluid in front of the nose, and of what lies before it, to behind the ears,
  /// from above the crown to the upper chest; further where the head is turned out of that.
  Box region_of_interest() const {
    const double crown = head_.landmarks.crown_m.y + head_.landmarks.head_position_m.y;
    const double front = std::min(-18 * kMillimetre * scale_, before_face_m_ - 2 * kMillimetre);
    Box box{{-40 * kMillimetre * scale_, crown - 3 * kMillimetre, front},
            scale_ * kMillimetre * glm::dvec3(40, 43, 42)};
    for (int axis = 0; axis < 3; ++axis) {
      if (skin_.low[axis] < box.low[axis]) box.low[axis] = skin_.low[axis] - kRoom_m;
      if (skin_.high[axis] > box.high[axis]) box.high[axis] = skin_.high[axis] + kRoom_m;
    }
    return box;
  }
  const glm::dvec3& suggested_position_m() const { return position_m_; }
  bool hand_is_before() const { return hand_is_before_; }
  bool has_placenta() const { return placenta_m_ > 0; }
  /// Of the skin, and of a hand before the face.
  std::vector<PartBody> skin_bodies() const {
    std::vector<PartBody> bodies = {{head_.skin, to_head_, head_.landmarks.head_position_m},
                                    {.shape = body_, .fillet_m = kTrunkFillet_m * scale_}};
    if (!hand_is_before_) bodies.push_back({.shape = hand_, .fillet_m = kMillimetre * scale_});
    return bodies;
  }
  std::vector<PartBody> hand_bodies() const { return {{.shape = hand_}}; }
  /// In the phantom frame.
  std::vector<Landmark> landmarks() const {
    std::vector<Landmark> all;
    const FetalLandmarks& pose = head_.landmarks;
    for (const NamedPoint& point : named_points(head_, child_.solved.shape)) {
      all.push_back(
          {std::string(point.name), pose.head_to_phantom * point.head_m + pose.head_position_m});
    }
    return all;
  }
  std::vector<PhantomMeasure> measures() const {
    std::vector<PhantomMeasure> all = measures_of(child_);
    all.insert(all.end(), gaps_.begin(), gaps_.end());
    return all;
  }
  /// Inner radius: that of the smallest ball that contains the skull, and a voxel's rounding; the
  /// jaw of an open mouth leaves it by little. Outer radius: short of the cavity's wall; the hand
  /// moves little.
  Joint joint() const {
    const glm::dvec3 in_head = middle_of_skull();
    const FetalLandmarks& pose = head_.landmarks;
    return {pose.head_to_phantom * in_head + pose.head_position_m,
            reach_of_skull(head_, in_head) + 0.6 * kMillimetre,
            50 * kMillimetre * scale_,
            mouth()};
  }

 private:
  static constexpr double kRoom_m = 3 * kMillimetre;

  glm::dvec3 middle_of_skull() const {
    return wobblebench::phantoms::middle_of_skull(child_.solved.shape);
  }
  Box posed_skin() const {
    const FetalLandmarks& pose = head_.landmarks;
    const Box turned = turned_skin(head_, middle_of_skull(), pose.head_to_phantom);
    return {turned.low + pose.head_position_m, turned.high + pose.head_position_m};
  }
  std::optional<Mouth> mouth() const {
    if (mouth_open_m_ == 0) return std::nullopt;
    const FetalLandmarks& pose = head_.landmarks;
    return Mouth{pose.head_to_phantom,
                 pose.head_to_phantom * pose.mouth_m + pose.head_position_m,
                 mouth_open_m_,
                 kJawReach_m * scale_};
  }
  double trunk_distance(const glm::dvec3& p) const {
    return smooth_union(
        head_.skin.distance(in_head(p)), body_.distance(p), kTrunkFillet_m * scale_);
  }
  /// The tubes at their gap before the face; `key` names it where there is no room.
  std::vector<Tube> placed(std::vector<Tube> tubes,
                           double thicker_m,
                           double gap_m,
                           const char* key) {
    const auto face = [this](const glm::dvec3& p) { return trunk_distance(p); };
    const double shift_m = place_before(face, tubes, thicker_m, gap_m);
    for (Tube& tube : tubes) tube = shifted(tube, {0, 0, shift_m});
    const auto wall = [this](const glm::dvec3& p) { return cavity_distance(p, scale_); };
    for (const Tube& tube : tubes) {
      for (const TubePoint& point : tube.points()) {
        before_face_m_ = std::min(before_face_m_, point.center.z - point.radius_m - thicker_m);
      }
    }
    if (most_outside(wall, tubes, thicker_m) > -4 * kMillimetre) {
      throw refusal(
          std::string(key) + "_gap_mm",
          gap_m / kMillimetre,
          "leaves no room between the face and the uterine wall for the " + std::string(key));
    }
    gaps_.push_back({std::string(key) + "_gap_mm", gap_m / kMillimetre, std::nullopt});
    return tubes;
  }
  CsgBody place_hand(const PhantomOptions& options) {
    return united_hand(
        placed(hand_before(scale_, options.gestational_age_weeks), 0, options.hand_gap_m, "hand"),
        1 * kMillimetre * scale_);
  }
  UmbilicalCord make_cord(const PhantomOptions& options) {
    if (options.cord == CordPlace::beside) return {scale_, cord_beside(scale_)};
    const double thicker_m = UmbilicalCord::radius_m(scale_) - kMillimetre * scale_;
    return {scale_, placed({cord_across(scale_)}, thicker_m, options.cord_gap_m, "cord").front()};
  }
  // The volume of interest starts in the fluid.
  void check_placenta(const PhantomOptions& options) const {
    const double front = cavity_front_m(scale_, 0, 0), box = region_of_interest().low.z;
    const double room_m = box - front - 1 * kMillimetre;
    if (options.placenta_m <= room_m) return;
    throw refusal("placenta_mm",
                  options.placenta_m / kMillimetre,
                  "must be at most " + significant(room_m / kMillimetre, 3) +
                      " here: beyond, it touches the face");
  }
  glm::dvec3 in_head(const glm::dvec3& p) const {
    return to_head_ * (p - head_.landmarks.head_position_m);
  }
  Ball in_head(const Ball& ball) const { return {in_head(ball.center), ball.radius_m}; }

  FetalChild child_;
  const FetalHead& head_;
  double scale_;  // of the surroundings, relative to 21 weeks
  double mouth_open_m_;
  glm::dmat3 to_head_;
  CsgBody body_, hand_;
  bool hand_is_before_;
  std::vector<PhantomMeasure> gaps_;
  double before_face_m_ = 0;  // least z of what was placed before the face
  UmbilicalCord cord_;
  double placenta_m_;
  Box skin_;  // of the head, in its pose; of its depth what is seen from before
  glm::dvec3 position_m_;
  MaternalLayer maternal_layer_;
};

struct SceneSurface {
  const char* name;
  const char* inside;
  bool is_target;
  DistanceFunction (FetalScene::*distance)(const Ball&) const;
  Distances distances;
  Part on, within;                                                // labels …
  std::vector<PartBody> (FetalScene::*bodies)() const = nullptr;  // … or what says them
};

// The parts, in painter's order.
constexpr SceneSurface kMaternalSurfaces[] = {{"maternal_muscle",
                                               "muscle",
                                               false,
                                               &FetalScene::muscle,
                                               Distances::exact,
                                               Part::maternal_muscle,
                                               Part::maternal_muscle},
                                              {"maternal_fat",
                                               "fat",
                                               false,
                                               &FetalScene::fat,
                                               Distances::exact,
                                               Part::maternal_fat,
                                               Part::maternal_fat},
                                              {"maternal_skin",
                                               "skin",
                                               false,
                                               &FetalScene::maternal_skin,
                                               Distances::exact,
                                               Part::maternal_skin,
                                               Part::maternal_skin}};
constexpr SceneSurface kFetalSurfaces[] = {
    {"cavity",
     "amniotic_fluid",
     true,
     &FetalScene::cavity,
     Distances::exact,
     Part::uterine_wall,
     Part::amniotic_fluid},
    {"placenta",
     "placenta",
     true,
     &FetalScene::placenta,
     Distances::first_order,
     Part::placenta,
     Part::placenta},
    {"cord",
     "umbilical_cord",
     true,
     &FetalScene::cord,
     Distances::first_order,
     Part::cord,
     Part::cord},
    {"hand",
     "fetal_skin",
     true,
     &FetalScene::hand,
     Distances::first_order,
     Part::hand,
     Part::hand,
     &FetalScene::hand_bodies},
    {"skin",
     "fetal_skin",
     true,
     &FetalScene::skin,
     Distances::first_order,
     Part::body,
     Part::body,
     &FetalScene::skin_bodies},
    {"skull",
     "fetal_skull",
     false,
     &FetalScene::skull,
     Distances::first_order,
     Part::skull,
     Part::skull},
    {"brain", "brain", false, &FetalScene::brain, Distances::first_order, Part::brain, Part::brain},
    {"eyes", "vitreous", false, &FetalScene::eyes, Distances::exact, Part::eye, Part::eye}};

PhantomParts parts_of(const FetalScene& scene, const std::vector<SceneSurface>& parts) {
  PhantomParts all{.background = Part::uterine_wall, .surfaces = {}};
  for (const SceneSurface& part : parts) {
    all.surfaces.push_back({part.on, part.within});
    if (part.bodies != nullptr) all.surfaces.back().bodies = (scene.*part.bodies)();
  }
  return all;
}

// The landmarks on the finished skin, which the grid rounds by little. Left out: what body or cleft
// have taken the place of.
std::vector<Landmark> on_finished_skin(const std::vector<Landmark>& wanted,
                                       const Phantom& phantom) {
  const double voxel_m = grid_memory(phantom, 0).voxel_m;
  const double farthest_m = std::max(0.5 * kMillimetre, voxel_m);
  constexpr int kSteps = 4;
  const auto& surfaces = phantom.surfaces();
  const auto skin =
      static_cast<int>(std::ranges::find(surfaces, "skin", &Surface::name) - surfaces.begin());
  const SurfaceFinder finder(phantom);
  const LabelFinder labels(phantom);
  int target = 0;
  while (finder.surface(target) != skin) ++target;
  std::vector<Landmark> landmarks;
  for (const Landmark& landmark : wanted) {
    glm::dvec3 at = landmark.position_m;
    for (int step = 0; step < kSteps; ++step) {
      const auto found = finder.target_distance(target, at);
      if (!found) break;
      const double steep = glm::length(found->gradient);
      at -= found->value_m / (steep * steep) * found->gradient;
    }
    const bool is_covered = labels.distance_m(skin, at) > 0.1 * voxel_m ||
                            glm::distance(at, landmark.position_m) > farthest_m;
    const auto part = static_cast<Part>(labels.on_surface(skin, at));
    if (!is_covered && part != Part::cleft) landmarks.push_back({landmark.name, at});
  }
  return landmarks;
}

}  // namespace

Phantom make_fetal_face(const PhantomOptions& options) {
  const FetalScene scene(options);
  std::vector<SceneSurface> parts;
  if (options.maternal_layer_m > 0) {
    parts.assign(std::begin(kMaternalSurfaces), std::end(kMaternalSurfaces));
  }
  const std::size_t maternal = parts.size();
  for (const SceneSurface& part : kFetalSurfaces) {
    const std::string_view name = part.name;
    if (name == "hand" && !scene.hand_is_before()) continue;
    if (name == "placenta" && !scene.has_placenta()) continue;
    parts.push_back(part);
  }
  std::vector<Surface> surfaces;
  for (const SceneSurface& part : parts) {
    surfaces.push_back({part.name, material_index(part.inside), part.is_target});
  }
  auto grids = std::make_shared<Grids>();
  grids->signed_distance.resize(parts.size());
  parallel_rows(static_cast<int>(parts.size()), [&](int row) {
    const auto i = static_cast<std::size_t>(row);
    const SceneSurface& part = parts[i];
    const LocalDistance distance = [&](const Ball& ball) { return (scene.*part.distance)(ball); };
    const Box bounds = i < maternal ? scene.maternal_bounds() : scene.cavity_bounds();
    grids->signed_distance[i] =
        build_level_set(part.name, distance, bounds, options.voxel_m, part.distances);
  });
  const Phantom unlabelled("fetal_face",
                           material_table(),
                           material_index("uterus_wall"),
                           surfaces,
                           scene.region_of_interest(),
                           scene.suggested_position_m(),
                           grids,
                           scene.joint());
  const PhantomParts labels = parts_of(scene, parts);
  const Phantom phantom = unlabelled.with_parts(labels, {});
  return phantom.with_parts(labels, on_finished_skin(scene.landmarks(), phantom))
      .with_measures(scene.measures());
}

}  // namespace wobblebench::phantoms
