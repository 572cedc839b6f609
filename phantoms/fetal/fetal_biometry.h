// Mean fetal biometry by gestational age.
#pragma once

namespace wobblebench::phantoms {

/// Means by gestational age, in metres.
struct FetalBiometry {
  double biparietal_m;       ///< BPD, outer to outer surface of the skull
  double head_around_m;      ///< HC, around the skull's outer surface in the BPD/OFD plane
  double occipitofrontal_m;  ///< OFD of the ellipse that has this BPD and HC
  double interocular_m;      ///< between the inner edges of the two orbits
  double binocular_m;        ///< between the outer edges of the two orbits
  double philtrum_m;         ///< base of the columella to the tip of the upper lip
  double chin_m;             ///< tip of the lower lip to the skin under the tip of the mandible
};

/// HC and BPD: INTERGROWTH-21st (Papageorghiou, Lancet 2014). Interocular and binocular distance:
/// Sukonpan 2008. Philtrum and chin: Gull, Fetal Diagn Ther 2005;20:127. OFD follows from BPD and
/// HC, so that the three agree exactly; the published OFD agrees with it within some millimetres.
/// Valid for 20 to 30 weeks, fractions included.
FetalBiometry fetal_biometry(double gestational_age_weeks);

/// Perimeter of the ellipse with these two diameters (Ramanujan 1914; within 1e-9 here).
double ellipse_perimeter(double diameter_a, double diameter_b);

}  // namespace wobblebench::phantoms
