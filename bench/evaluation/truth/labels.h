// Labels of a picture's truth: what hides each true surface point from the probe, and where the
// landmarks of the phantom are in this scan.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "bench/evaluation/truth/scanned_surfaces.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/evaluation/truth/truth.h"
#include "bench/scene/resolved_scene.h"
#include "phantoms/label_finder.h"

namespace wobblebench::bench {

/// What lies before a point on the stick through it. Threads must not share one: each takes a copy.
class SightLines {
 public:
  /// `view`: whose volume of interest holds the points.
  SightLines(const phantoms::PlacedPhantom& subject,
             const hw::AcquisitionPlan& plan,
             const render::View& view,
             std::uint32_t volume = 0);

  /// Label of the first surface that the sound enters from fluid before it comes to the point, of
  /// the probe frame; 0: there is none. What the mother has before the fluid hides nothing, nor
  /// does a rim of the point's own surface less than 1 mm before it.
  std::uint8_t before(const glm::dvec3& position_m) const;

 private:
  bool is_fluid(const glm::dvec3& position_m) const;
  glm::dvec3 at_rest(const glm::dvec3& position_m) const;

  phantoms::Phantom phantom_;
  hw::ProbeGeometry geometry_;
  ScannedSurfaces surfaces_;
  phantoms::LabelFinder labels_;
};

/// A landmark of the phantom at the time of the stick that images it.
struct SeenLandmark {
  std::string name;
  glm::dvec3 position_m{0};  ///< probe frame
  render::PicturePoint at;   ///< where it is, or would be, in the picture
  TruthKind kind = TruthKind::none;
  std::uint8_t before = 0;  ///< as Labels::before
  bool in_picture = false;  ///< its pixel shows it: nothing is before it on the picture's ray

  /// The probe's sound reaches it, with nothing before it.
  bool is_visible() const { return kind == TruthKind::surface && before == 0; }
};

struct Labels {
  Image<std::uint8_t> before;  ///< as SightLines::before(); 0 also where the ray crosses nothing
  std::vector<phantoms::LabelName> names;  ///< that Truth::part, `before` and the landmarks have
  std::vector<SeenLandmark> landmarks;

  /// 1 where the probe sees the true surface with nothing before it.
  static bool is_visible(TruthKind kind, std::uint8_t before) {
    return kind == TruthKind::surface && before == 0;
  }
};

/// Of the truth of a scene's picture; its subject must be known. `reach`: that the truth was marked
/// with.
Labels label_truth(const ResolvedScene& scene,
                   const Truth& truth,
                   const StickReach& reach,
                   std::uint32_t volume = 0);

}  // namespace wobblebench::bench
