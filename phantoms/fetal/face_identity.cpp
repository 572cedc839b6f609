#include "phantoms/fetal/face_identity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "base/hash.h"
#include "base/units.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kMostZ = 3;

// Of right minus left, in the adult's face; assumed: no figure for a fetus was found. Children of
// 6 to 12 years leave their mirror image by 0.96 +- 0.52 mm, unsigned (Chou 2019).
constexpr double kAsymmetry_m = 0.5 * kMillimetre;

// Standard normal numbers of one name.
class Draw {
 public:
  Draw(std::uint64_t seed, std::string_view name) : key_(mix64(seed + kGoldenGamma)) {
    for (const char letter : name) {
      key_ = mix64(key_ ^
                   (static_cast<std::uint64_t>(static_cast<unsigned char>(letter)) + kGoldenGamma));
    }
  }

  /// Box-Muller transform of two uniform numbers.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * kPi * uniform());
  }
  /// Within kMostZ of 0.
  double bounded() {
    double z = normal();
    while (std::abs(z) > kMostZ) z = normal();
    return z;
  }

 private:
  double uniform() { return unit_interval(mix64(key_ + ++drawn_ * kGoldenGamma)); }

  std::uint64_t key_;
  std::uint64_t drawn_ = 0;
};

// Of a size that shares the factor `common` with the correlation r.
double correlated(Draw& draw, double common, double r) {
  return std::sqrt(r) * common + std::sqrt(1 - r) * draw.normal();
}

// Z-score of the facial height, which philtrum, lips and chin are parts of: their own deviations,
// and that of the nose, so scaled that the variance is 1. `r`: correlation of the sizes.
class HeightOfParts {
 public:
  HeightOfParts(double weeks, double r) {
    const auto share = [&](FaceMeasure part) {
      const FaceMeasureLaw &law = law_of(part), &whole = law_of(FaceMeasure::facial_height);
      return law.mean(weeks) * true_spread(law, weeks) / true_spread(whole, weeks);
    };
    constexpr double kSlope = 0.8;  // of the line from lip to chin, against the vertical
    philtrum_ = share(FaceMeasure::philtrum);
    chin_ = kSlope * share(FaceMeasure::chin);
    const double of_parts = philtrum_ * philtrum_ + chin_ * chin_ + 2 * r * philtrum_ * chin_;
    const double common = r * (philtrum_ + chin_);
    nose_ = std::sqrt(std::max(common * common - of_parts + 1, 0.0)) - common;
  }
  double z(double philtrum_z, double chin_z, double nose_z) const {
    return philtrum_ * philtrum_z + chin_ * chin_z + nose_ * nose_z;
  }

 private:
  double philtrum_, chin_, nose_;
};

using Scores = std::array<double, kFaceMeasures>;

double& score(Scores& scores, FaceMeasure measure) {
  return scores[static_cast<std::size_t>(measure)];
}

Scores draw_scores(std::uint64_t seed, double weeks) {
  const double r = size_correlation(weeks);
  const auto& laws = face_measure_laws();
  Scores z{};
  const double common = Draw(seed, law_of(FaceMeasure::head_circumference).name).bounded();
  for (std::size_t i = 0; i < kFaceMeasures; ++i) {
    Draw own(seed, laws[i].name);
    do {
      z[i] = laws[i].is_size ? correlated(own, common, r) : own.normal();
    } while (std::abs(z[i]) > kMostZ);
  }
  score(z, FaceMeasure::head_circumference) = common;
  const HeightOfParts height(weeks, r);
  Draw nose(seed, law_of(FaceMeasure::facial_height).name);
  double& whole = score(z, FaceMeasure::facial_height);
  do {
    whole = height.z(
        score(z, FaceMeasure::philtrum), score(z, FaceMeasure::chin), correlated(nose, common, r));
  } while (std::abs(whole) > kMostZ);
  return z;
}

FaceMeasures draw_measures(std::uint64_t seed, double weeks) {
  const Scores z = draw_scores(seed, weeks);
  FaceMeasures drawn;
  for (std::size_t i = 0; i < kFaceMeasures; ++i) {
    drawn.values[i] = value_at(face_measure_laws()[i], weeks, z[i]);
  }
  return drawn;
}

struct TraitSpread {
  std::string_view name;
  double FaceTraits::*trait;
  double spread;
};

constexpr TraitSpread kTraits[] = {{"mouth_width", &FaceTraits::mouth_width, 0.08},
                                   {"lip_fullness", &FaceTraits::lip_fullness, 0.12},
                                   {"nose_width", &FaceTraits::nose_width, 0.10},
                                   {"nostril_tilt", &FaceTraits::nostril_tilt, 0.4},
                                   {"ear_breadth", &FaceTraits::ear_breadth, 0.10},
                                   {"ear_stands_off", &FaceTraits::ear_stands_off, 0.5},
                                   {"brow", &FaceTraits::brow, 0.5},
                                   {"cheek_full", &FaceTraits::cheek_full, 0.9},
                                   {"chin_width", &FaceTraits::chin_width, 0.10},
                                   {"chin_point", &FaceTraits::chin_point, 0.4},
                                   {"eye_slant", &FaceTraits::eye_slant, 0.5},
                                   {"eye_depth", &FaceTraits::eye_depth, 0.5},
                                   {"nose_bridge", &FaceTraits::nose_bridge, 0.4},
                                   {"crown", &FaceTraits::crown, 0.02}};

constexpr std::string_view kPaired[kPairedParts] = {"eye asymmetry",
                                                    "brow asymmetry",
                                                    "cheek asymmetry",
                                                    "ala asymmetry",
                                                    "mouth asymmetry",
                                                    "ear asymmetry",
                                                    "jaw asymmetry",
                                                    "zygoma asymmetry",
                                                    "nose tip asymmetry"};

Asymmetry draw_asymmetry(std::uint64_t seed, double weeks) {
  const double spread_m = kAsymmetry_m * weeks / 40;
  Asymmetry asymmetry{};
  for (std::size_t part = 0; part < kPairedParts; ++part) {
    Draw draw(seed, kPaired[part]);
    glm::dvec3& shift = asymmetry[part];
    shift.x = spread_m * draw.bounded();
    shift.y = spread_m * draw.bounded();
    shift.z = spread_m * draw.bounded();
  }
  asymmetry[static_cast<std::size_t>(PairedPart::nose_tip)] *= glm::dvec3(1, 0, 0);
  return asymmetry;
}

}  // namespace

FaceIdentity draw_identity(std::uint64_t seed, double weeks) {
  FaceIdentity identity{.weeks = weeks, .measures = mean_face(weeks)};
  if (seed == 0) return identity;
  identity.measures = draw_measures(seed, weeks);
  for (const TraitSpread& each : kTraits) {
    identity.traits.*each.trait += each.spread * Draw(seed, each.name).bounded();
  }
  identity.asymmetry = draw_asymmetry(seed, weeks);
  return identity;
}

}  // namespace wobblebench::phantoms
