// Labels of surfaces and of what they enclose, and landmarks.
#include "phantoms/label_finder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "base/units.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/io/vdb_file.h"
#include "phantoms/truth.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

Phantom upright(PhantomOptions options) {
  options.head_pitch_rad = options.head_yaw_rad = options.head_roll_rad = 0;
  return make_phantom(options);
}

/// Made once.
const Phantom& upright_face() {
  static const Phantom face = upright({});
  return face;
}

int index_of(const Phantom& phantom, const std::string& surface) {
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    if (phantom.surfaces()[i].name == surface) return static_cast<int>(i);
  }
  return -1;
}

std::map<std::string, glm::dvec3> landmarks_of(const Phantom& phantom) {
  std::map<std::string, glm::dvec3> found;
  for (const Landmark& landmark : phantom.landmarks()) found[landmark.name] = landmark.position_m;
  return found;
}

/// Numbers from `begin` up to `end`, without it.
std::vector<double> steps(double begin, double end, double step) {
  std::vector<double> numbers(static_cast<std::size_t>(std::ceil((end - begin) / step)));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = begin + static_cast<double>(i) * step;
  }
  return numbers;
}

/// What a line of sight from the probe's side meets first: bisection on all grids of the phantom.
struct Met {
  int surface = -1;
  glm::dvec3 at{0};
};
Met met_from_front(const Phantom& phantom, double x, double y) {
  const LabelFinder finder(phantom);
  const auto& box = phantom.region_of_interest();
  const int fluid = index_of(phantom, "cavity");
  constexpr double kStep_m = 0.05e-3;
  for (const double z : steps(box.low.z, box.high.z, kStep_m)) {
    const int enclosing = finder.enclosing({x, y, z});
    if (enclosing != fluid) return {enclosing, {x, y, z}};
  }
  return {};
}

TEST(Parts, NumbersAndNamesAreUnique) {
  std::set<int> numbers;
  std::set<std::string_view> names;
  int last = 0;
  for (const PartName& part : part_names()) {
    EXPECT_GT(static_cast<int>(part.part), last);
    last = static_cast<int>(part.part);
    EXPECT_LT(last, kUnnamedBackground);
    EXPECT_TRUE(names.insert(part.name).second) << part.name;
    EXPECT_FALSE(part.meaning.empty());
  }
}

// Numbers that files of others hold.
TEST(Parts, KeepTheirNumbers) {
  const std::map<std::string_view, int> kept = {
      {"forehead", 1},      {"brow", 2},           {"eyelids", 3},        {"nose", 4},
      {"philtrum", 5},      {"upper_lip", 6},      {"lower_lip", 7},      {"mouth", 8},
      {"tongue", 9},        {"chin", 10},          {"jaw", 11},           {"cheek", 12},
      {"cheekbone", 13},    {"ear", 14},           {"face_base", 15},     {"around_mouth", 16},
      {"cleft", 17},        {"neck", 20},          {"body", 21},          {"arm", 22},
      {"hand", 23},         {"cord", 24},          {"skull", 30},         {"brain", 31},
      {"eye", 32},          {"uterine_wall", 40},  {"placenta", 41},      {"maternal_muscle", 42},
      {"maternal_fat", 43}, {"maternal_skin", 44}, {"amniotic_fluid", 50}};
  EXPECT_EQ(part_names().size(), kept.size());
  for (const PartName& part : part_names()) {
    EXPECT_EQ(static_cast<int>(part.part), kept.at(part.name)) << part.name;
  }
}

TEST(PartDistances, NameTheNearerShapeOfAUnion) {
  CsgBody body;
  body.begin(Part::nose);
  body.unite(Ellipsoid{{-10, 0, 0}, {8, 8, 8}}, 0);
  body.begin(Part::cheek);
  body.unite(Ellipsoid{{10, 0, 0}, {8, 8, 8}}, 3);
  // The two are mirror images: the border is the plane between them, fillet or not.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-20, 20);
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 p(number(random), number(random), number(random));
    const PartDistance found = body.part_distance(p);
    EXPECT_EQ(found.part, p.x < 0 ? Part::nose : Part::cheek) << p.x;
    EXPECT_EQ(found.distance, body.distance(p));
  }
}

TEST(PartDistances, NameTheToolWhereItCuts) {
  CsgBody body;
  body.begin(Part::chin);
  body.unite(Ellipsoid{{0, 0, 0}, {10, 10, 10}}, 0);
  body.begin(Part::mouth);
  body.subtract(Ellipsoid{{0, 0, -10}, {4, 4, 4}}, 0.5);
  EXPECT_EQ(body.part_distance({0, 0, -6}).part, Part::mouth) << "floor of the hole";
  EXPECT_EQ(body.part_distance({0, 0, -10}).part, Part::mouth) << "within the hole";
  EXPECT_EQ(body.part_distance({0, 0, 10}).part, Part::chin) << "other side";
  EXPECT_EQ(body.part_distance({10, 0, 0}).part, Part::chin);
}

TEST(Labels, OfTheFaceAreWhereTheFieldHasThem) {
  const Phantom& face = upright_face();
  const auto points = landmarks_of(face);
  const LabelFinder finder(face);
  const int skin = index_of(face, "skin");
  const std::map<std::string, std::set<Part>> expected = {
      {"vertex", {Part::forehead}},
      {"pronasale", {Part::nose}},
      {"stomion", {Part::mouth}},
      {"labiale_superius", {Part::upper_lip}},
      {"labiale_inferius", {Part::lower_lip}},
      {"pogonion", {Part::chin}},
      {"gnathion", {Part::chin}},
      {"menton", {Part::chin}},
      {"endocanthion_left", {Part::eyelids}},
      {"exocanthion_right", {Part::eyelids}},
      {"cheilion_left", {Part::mouth, Part::upper_lip, Part::lower_lip}},
      {"subnasale", {Part::philtrum, Part::nose}},
      {"superaurale_left", {Part::ear}},
      {"subaurale_right", {Part::ear}}};
  for (const auto& [name, parts] : expected) {
    ASSERT_TRUE(points.contains(name)) << name;
    const auto found = static_cast<Part>(finder.on_surface(skin, points.at(name)));
    EXPECT_TRUE(parts.contains(found)) << name << ": " << static_cast<int>(found);
  }
}

// Seen from in front, without any knowledge of shapes: parts lie in the order that a face has.
TEST(Labels, FollowEachOtherDownTheProfile) {
  const Phantom& face = upright_face();
  const LabelFinder finder(face);
  const int skin = index_of(face, "skin");
  std::vector<Part> order;
  const auto points = landmarks_of(face);
  for (const double y :
       steps(points.at("vertex").y + 5e-3, points.at("menton").y - 0.5e-3, 0.2e-3)) {
    const Met met = met_from_front(face, 0, y);
    if (met.surface != skin) continue;
    const auto part = static_cast<Part>(finder.on_surface(skin, met.at));
    if (order.empty() || order.back() != part) order.push_back(part);
  }
  std::vector<Part> named;
  for (const Part part : order) {
    if (part == Part::forehead || part == Part::nose || part == Part::upper_lip ||
        part == Part::mouth || part == Part::lower_lip || part == Part::chin) {
      if (named.empty() || named.back() != part) named.push_back(part);
    }
  }
  const std::vector<Part> wanted = {
      Part::forehead, Part::nose, Part::upper_lip, Part::mouth, Part::lower_lip, Part::chin};
  EXPECT_EQ(named, wanted);
}

TEST(Labels, OfAMirroredFaceAreMirrored) {
  const Phantom& face = upright_face();  // identity 0 is symmetric
  const LabelFinder finder(face);
  const int skin = index_of(face, "skin");
  int compared = 0, other = 0;
  for (const double y : steps(-30e-3, 26e-3, 1.3e-3)) {
    for (const double x : steps(0.4e-3, 30e-3, 1.1e-3)) {
      const Met right = met_from_front(face, x, y), left = met_from_front(face, -x, y);
      if (right.surface != skin || left.surface != skin) continue;
      const auto a = static_cast<Part>(finder.on_surface(skin, right.at));
      const auto b = static_cast<Part>(finder.on_surface(skin, left.at));
      if (a >= Part::neck || b >= Part::neck) continue;  // one arm is raised
      ++compared;
      other += a != b;
    }
  }
  EXPECT_GT(compared, 700);
  EXPECT_LE(other, compared / 200) << "only where a step of the march straddles a border";
}

TEST(Labels, NameHandCordPlacentaAndCleft) {
  const Phantom face = upright({.voxel_m = 1e-3,
                                .cleft_width_m = 3e-3,
                                .hand = HandPlace::before,
                                .hand_gap_m = 2e-3,
                                .cord = CordPlace::before,
                                .placenta_m = 5e-3});
  std::map<Part, int> seen;
  const LabelFinder finder(face);
  for (const double y : steps(-40e-3, 40e-3, 1e-3)) {
    for (const double x : steps(-38e-3, 38e-3, 1e-3)) {
      const Met met = met_from_front(face, x, y);
      if (met.surface >= 0) ++seen[static_cast<Part>(finder.on_surface(met.surface, met.at))];
    }
  }
  EXPECT_GT(seen[Part::hand], 200);
  EXPECT_GT(seen[Part::arm], 50);
  EXPECT_GT(seen[Part::cord], 300);
  EXPECT_GT(seen[Part::forehead], 300);
  // In front of the volume of interest, on the axis.
  const glm::dvec3 front(0, 0, face.region_of_interest().low.z);
  std::set<Part> before;
  for (const double z : steps(0, 20e-3, 0.2e-3)) {
    before.insert(static_cast<Part>(finder.at(front - glm::dvec3(0, 0, z))));
  }
  EXPECT_TRUE(before.contains(Part::amniotic_fluid));
  EXPECT_TRUE(before.contains(Part::placenta));
  EXPECT_TRUE(before.contains(Part::uterine_wall));
  // The cleft lies behind the hand: on the skin itself, at the lip's height beside the midline.
  const Phantom bare = upright({.cleft_width_m = 3e-3});
  const LabelFinder labels(bare);
  int cleft = 0;
  for (const double y : steps(5e-3, 15e-3, 0.3e-3)) {
    for (const double x : steps(-6e-3, 6e-3, 0.3e-3)) {
      const Met met = met_from_front(bare, x, y);
      if (met.surface != index_of(bare, "skin")) continue;
      if (static_cast<Part>(labels.on_surface(met.surface, met.at)) != Part::cleft) continue;
      ++cleft;
      EXPECT_GT(x, 0) << "the child's left";
    }
  }
  EXPECT_GT(cleft, 20);
}

TEST(Labels, WithinTheChildAreThoseOfItsTissues) {
  const Phantom face = upright({.voxel_m = 1e-3});
  const LabelFinder finder(face);
  const auto label = [&](double x, double y, double z) {
    return static_cast<Part>(finder.at(1e-3 * glm::dvec3(x, y, z)));
  };
  EXPECT_EQ(label(0, -20, 35), Part::brain);
  EXPECT_EQ(label(0, 60, 40), Part::body);
  EXPECT_EQ(label(0, -70, 0), Part::amniotic_fluid);
  EXPECT_EQ(label(0, 0, -45), Part::uterine_wall);
}

TEST(Labels, OfPhantomsWithoutNamesAreThoseOfTheirSurfaces) {
  const Phantom ball = make_phantom({.name = "sphere", .voxel_m = 1e-3, .radius_m = 10e-3});
  EXPECT_EQ(ball.parts(), nullptr);
  const LabelFinder finder(ball);
  EXPECT_EQ(finder.at({0, 0, 0}), kFirstUnnamed);
  EXPECT_EQ(finder.on_surface(0, {0, 0, 10e-3}), kFirstUnnamed);
  EXPECT_EQ(finder.at({0, 0, 15e-3}), kUnnamedBackground);
  const auto names = label_names(ball);
  ASSERT_EQ(names.size(), 2U);
  EXPECT_EQ(names[1].name, ball.surfaces()[0].name);
}

/// Identities and scenes with all that moves landmarks.
const std::vector<PhantomOptions>& scenes() {
  static const std::vector<PhantomOptions> all = {
      {.gestational_age_weeks = 24, .identity = 11},
      {.identity = 7, .mouth_open_m = 5e-3, .head_pitch_rad = 25 * kDegree, .tongue_m = 2e-3},
      {.smile_m = 2e-3, .lids_open_m = 2e-3, .cleft_width_m = 4e-3, .cleft_alveolus_m = 3e-3},
      {.hand = HandPlace::before, .hand_gap_m = 0}};
  return all;
}

/// Largest distance of a landmark of one phantom from the skin of another, by name.
std::map<std::string, double> distances_m(const Phantom& of, const Phantom& to) {
  const SurfaceFinder finder(to);
  int skin = 0;
  while (finder.surface(skin) != index_of(to, "skin")) ++skin;
  std::map<std::string, double> found;
  for (const auto& [name, at] : landmarks_of(of)) {
    const auto distance = finder.target_distance(skin, at);
    found[name] = distance ? std::abs(distance->value_m) : 1;
  }
  return found;
}

TEST(Landmarks, LieOnTheSkin) {
  for (const PhantomOptions& options : scenes()) {
    const Phantom phantom = make_phantom(options);
    EXPECT_GE(phantom.landmarks().size(), 15U);
    for (const auto& [name, distance_m] : distances_m(phantom, phantom)) {
      EXPECT_LT(distance_m, 0.02e-3) << name << ", identity " << options.identity;
    }
  }
}

// The grid rounds the corners of lids and mouth, grooves of its voxels' size, by little.
TEST(Landmarks, LieOnTheSkinOfAFinerGrid) {
  PhantomOptions options = scenes().front();
  const Phantom phantom = make_phantom(options);
  options.voxel_m = 0.35e-3;
  for (const auto& [name, distance_m] : distances_m(phantom, make_phantom(options))) {
    const bool in_groove = name.find("canthion") != std::string::npos;
    EXPECT_LT(distance_m, in_groove ? 0.15e-3 : 0.1e-3) << name;
  }
}

TEST(Landmarks, AreLeftOutWhereTheHeadHasNone) {
  EXPECT_TRUE(landmarks_of(make_phantom({.voxel_m = 1e-3})).contains("stomion"));
  const auto open = landmarks_of(make_phantom({.voxel_m = 1e-3, .mouth_open_m = 4e-3}));
  EXPECT_FALSE(open.contains("stomion"));
  EXPECT_TRUE(open.contains("menton"));
}

TEST(Landmarks, OfASymmetricFaceAreMirrorImages) {
  const auto points = landmarks_of(upright_face());
  for (const char* name : {"endocanthion", "exocanthion", "cheilion", "superaurale", "subaurale"}) {
    const glm::dvec3 left = points.at(std::string(name) + "_left");
    const glm::dvec3 right = points.at(std::string(name) + "_right");
    EXPECT_GT(left.x, 0) << name;
    EXPECT_LT(glm::distance(left, right * glm::dvec3(-1, 1, 1)), 0.2e-3) << name;
  }
  EXPECT_LT(points.at("endocanthion_left").x, points.at("exocanthion_left").x);
}

/// Points of the finished skin seen from in front about a point, with their labels.
struct SeenSkin {
  glm::dvec3 at{0};
  Part part = Part::none;
};
std::vector<SeenSkin> skin_about(const Phantom& phantom, const glm::dvec3& middle, double half_m) {
  const LabelFinder finder(phantom);
  const int skin = index_of(phantom, "skin");
  std::vector<SeenSkin> seen;
  for (const double y : steps(middle.y - half_m, middle.y + half_m, 0.2e-3)) {
    for (const double x : steps(middle.x - half_m, middle.x + half_m, 0.1e-3)) {
      for (const double z : steps(middle.z - 6e-3, middle.z + 6e-3, 0.05e-3)) {
        if (finder.enclosing({x, y, z}) != skin) continue;
        seen.push_back({{x, y, z}, static_cast<Part>(finder.on_surface(skin, {x, y, z}))});
        break;
      }
    }
  }
  return seen;
}

// By a search over the labels of the finished skin.
TEST(Landmarks, CornersOfTheMouthAreTheEndsOfTheLineBetweenTheLips) {
  for (const PhantomOptions& options :
       std::vector<PhantomOptions>{{.identity = 4},
                                   {.gestational_age_weeks = 30, .identity = 7},
                                   {.identity = 8, .mouth_open_m = 5e-3}}) {
    const Phantom face = upright(options);
    const auto points = landmarks_of(face);
    for (const double side : {-1.0, 1.0}) {
      const char* name = side > 0 ? "cheilion_left" : "cheilion_right";
      ASSERT_TRUE(points.contains(name)) << options.identity;
      const glm::dvec3 corner = points.at(name);
      double nearest_m = 1, outermost_m = 0;
      for (const SeenSkin& seen : skin_about(face, corner, 2.5e-3)) {
        if (seen.part != Part::mouth) continue;
        nearest_m = std::min(nearest_m, glm::distance(seen.at, corner));
        outermost_m = std::max(outermost_m, side * seen.at.x);
      }
      EXPECT_LT(nearest_m, 0.25e-3) << name << ", identity " << options.identity;
      EXPECT_NEAR(outermost_m, side * corner.x, 0.6e-3)
          << name << ", identity " << options.identity;
    }
  }
}

TEST(Landmarks, NothingOfTheNoseIsBeforeItsTip) {
  const Phantom face = upright({.cleft_width_m = 6e-3});
  const glm::dvec3 tip = landmarks_of(face).at("pronasale");
  for (const SeenSkin& seen : skin_about(face, tip, 3e-3)) {
    EXPECT_GT(seen.at.z, tip.z - 0.06e-3) << seen.at.x - tip.x << ' ' << seen.at.y - tip.y;
  }
}

using LabelFile = testing_support::FolderTest;

TEST_F(LabelFile, HasTheLabelOfEveryVoxel) {
  const Phantom face = make_phantom({.voxel_m = 2e-3});
  write_labels(face, file("labels.vdb"));
  const VdbFile read = read_vdb(file("labels.vdb"));
  ASSERT_EQ(read.grids.size(), 1U);
  EXPECT_EQ(read.grids[0].name, "part");
  EXPECT_EQ(read.metadata.metaValue<std::string>("label.4"), "nose");
  ASSERT_NE(read.grids[0].distances, nullptr);
  const FloatGrid& grid = *read.grids[0].distances;
  const LabelFinder finder(face);
  const auto values = grid.getConstAccessor();
  std::mt19937 random(5);
  std::uniform_int_distribution<int> number(-45, 45);
  std::set<int> seen;
  for (int i = 0; i < 20000; ++i) {
    const openvdb::Coord voxel(number(random), number(random), number(random));
    const int label = finder.at(to_glm(grid.indexToWorld(voxel)));
    EXPECT_EQ(static_cast<int>(values.getValue(voxel)), label);
    seen.insert(label);
  }
  EXPECT_GT(seen.size(), 12U);
}

}  // namespace
}  // namespace wobblebench::phantoms
