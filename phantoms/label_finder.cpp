#include "phantoms/label_finder.h"

#include <openvdb/math/Stencils.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"

namespace wobblebench::phantoms {
namespace {

constexpr std::array<PartName, 31> kPartNames = {{
    {Part::forehead, "forehead", "forehead and scalp: the skin over the braincase"},
    {Part::brow, "brow", "ridge above the eye"},
    {Part::eyelids, "eyelids", "lids, the opening between them, and the hollow about them"},
    {Part::nose, "nose", "ridge, tip, wings and nostrils"},
    {Part::philtrum, "philtrum", "groove between nose and upper lip"},
    {Part::upper_lip, "upper_lip", "red and roll of the upper lip"},
    {Part::lower_lip, "lower_lip", "red and roll of the lower lip"},
    {Part::mouth, "mouth", "line between closed lips, or the cavity between open ones"},
    {Part::tongue, "tongue", "tongue before the lips"},
    {Part::chin, "chin", "chin and the fold under the lower lip"},
    {Part::jaw, "jaw", "lower edge of the face from the ear to the chin"},
    {Part::cheek, "cheek", "soft cheek"},
    {Part::cheekbone, "cheekbone", "skin over the zygomatic bone, and the temple"},
    {Part::ear, "ear", "outer ear"},
    {Part::face_base, "face_base", "base of the face, where nothing stands out from it"},
    {Part::around_mouth, "around_mouth", "rounded base that carries the lips"},
    {Part::cleft, "cleft", "sides and floor of a cleft of lip and jaw"},
    {Part::neck, "neck", "neck"},
    {Part::body, "body", "trunk and shoulders"},
    {Part::arm, "arm", "forearm"},
    {Part::hand, "hand", "back of the hand, thumb and fingers"},
    {Part::cord, "cord", "umbilical cord"},
    {Part::skull, "skull", "bone of the skull and the face"},
    {Part::brain, "brain", "within the braincase"},
    {Part::eye, "eye", "globe of the eye"},
    {Part::uterine_wall, "uterine_wall", "wall of the amniotic cavity and what is about it"},
    {Part::placenta, "placenta", "placenta on the front wall"},
    {Part::maternal_muscle, "maternal_muscle", "muscle of the mother's abdominal wall"},
    {Part::maternal_fat, "maternal_fat", "fat of the mother's abdominal wall"},
    {Part::maternal_skin, "maternal_skin", "skin of the mother's abdominal wall"},
    {Part::amniotic_fluid, "amniotic_fluid", "fluid about the child"},
}};

// The body's distance and part, and then those of the union with the next.
PartDistance united(const std::vector<PartBody>& bodies, const glm::dvec3& rest_m) {
  PartDistance all{std::numeric_limits<double>::infinity()};
  for (const PartBody& body : bodies) {
    const PartDistance next = body.shape.part_distance(body.to_body * (rest_m - body.position_m));
    if (next.distance < all.distance) all.part = next.part;
    all.distance = smooth_union(all.distance, next.distance, body.fillet_m);
  }
  return all;
}

std::uint8_t unnamed(std::size_t surface) {
  return static_cast<std::uint8_t>(std::min(surface + kFirstUnnamed, std::size_t{kLastUnnamed}));
}

}  // namespace

std::span<const PartName> part_names() {
  return kPartNames;
}

Part SurfaceParts::part_on(const glm::dvec3& rest_m) const {
  return bodies.empty() ? on : united(bodies, rest_m).part;
}

Part SurfaceParts::part_inside(const glm::dvec3& rest_m) const {
  return bodies.empty() ? inside : united(bodies, rest_m).part;
}

struct LabelFinder::State {
  struct Sampled {
    explicit Sampled(std::shared_ptr<const FloatGrid> g) : grid(std::move(g)), stencil(*grid) {}
    Sampled(const Sampled& other) : Sampled(other.grid) {}

    double signed_distance_m(const glm::dvec3& rest_m) {
      const openvdb::Vec3d index = grid->worldToIndex(to_vdb(rest_m));
      stencil.moveTo(index);
      return static_cast<double>(stencil.interpolation(index));
    }

    std::shared_ptr<const FloatGrid> grid;
    openvdb::math::BoxStencil<const FloatGrid> stencil;
  };

  explicit State(const Phantom& of) : phantom(of) {
    for (const auto& grid : phantom.grids().signed_distance) surfaces.emplace_back(grid);
  }

  Phantom phantom;
  std::vector<Sampled> surfaces;
};

LabelFinder::LabelFinder(const Phantom& phantom) : state_(std::make_unique<State>(phantom)) {}
LabelFinder::LabelFinder(const LabelFinder& other)
    : state_(std::make_unique<State>(*other.state_)) {}
LabelFinder::~LabelFinder() = default;

std::uint8_t LabelFinder::on_surface(int surface, const glm::dvec3& rest_m) const {
  const auto index = static_cast<std::size_t>(surface);
  const PhantomParts* parts = state_->phantom.parts();
  if (parts == nullptr) return unnamed(index);
  return static_cast<std::uint8_t>(parts->surfaces.at(index).part_on(rest_m));
}

double LabelFinder::distance_m(int surface, const glm::dvec3& rest_m) const {
  return std::abs(state_->surfaces.at(static_cast<std::size_t>(surface)).signed_distance_m(rest_m));
}

int LabelFinder::enclosing(const glm::dvec3& rest_m) const {
  for (std::size_t i = state_->surfaces.size(); i-- > 0;) {
    if (state_->surfaces[i].signed_distance_m(rest_m) < 0) return static_cast<int>(i);
  }
  return -1;
}

std::uint8_t LabelFinder::inside(int surface, const glm::dvec3& rest_m) const {
  const auto index = static_cast<std::size_t>(surface);
  const PhantomParts* parts = state_->phantom.parts();
  if (parts == nullptr) return unnamed(index);
  return static_cast<std::uint8_t>(parts->surfaces.at(index).part_inside(rest_m));
}

std::uint8_t LabelFinder::at(const glm::dvec3& rest_m) const {
  const int surface = enclosing(rest_m);
  if (surface >= 0) return inside(surface, rest_m);
  const PhantomParts* parts = state_->phantom.parts();
  return parts == nullptr ? kUnnamedBackground : static_cast<std::uint8_t>(parts->background);
}

std::vector<LabelName> label_names(const Phantom& phantom) {
  std::vector<LabelName> names;
  if (phantom.parts() != nullptr) {
    for (const PartName& part : part_names()) {
      names.push_back({static_cast<std::uint8_t>(part.part), std::string(part.name)});
    }
    return names;
  }
  names.push_back({kUnnamedBackground, "background"});
  const auto& surfaces = phantom.surfaces();
  constexpr std::size_t kMost = kLastUnnamed - kFirstUnnamed + 1;
  for (std::size_t i = 0; i < std::min(surfaces.size(), kMost); ++i) {
    names.push_back({unnamed(i), surfaces[i].name});
  }
  if (surfaces.size() > kMost) names.back().name = "others";
  return names;
}

}  // namespace wobblebench::phantoms
