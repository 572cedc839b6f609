#include "phantoms/fetal/face_measures.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace wobblebench::phantoms {
namespace {

// Linear between the values of two whole weeks, 20 to 34.
double of_table(const std::array<double, 15>& table, double weeks) {
  const double at = std::clamp(weeks - 20, 0.0, 14.0);
  const auto below = static_cast<std::size_t>(std::min(at, 13.0));
  const double share = at - static_cast<double>(below);
  return table[below] + share * (table[below + 1] - table[below]);
}

template <int kThousandths>
double constant(double) {
  return 1e-3 * kThousandths;
}

double circumference_mean(double g) {
  return -28.2849 + 1.69267 * g * g - 0.397485 * g * g * std::log(g);
}
double circumference_spread(double g) {
  const double cube = g * g * g, ln = std::log(g);
  return 1.98735 + 0.0136772 * cube - 0.00726264 * cube * ln + 0.000976253 * cube * ln * ln;
}

// Mean BPD over the OFD of the ellipse of mean BPD and HC: the three agree exactly.
double cephalic_index_mean(double g) {
  const double width = 5.60878 + 0.158369 * g * g - 0.00256379 * g * g * g;
  const double around = circumference_mean(g);
  double low = width, high = around;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (ellipse_perimeter(width, middle) < around ? low : high) = middle;
  }
  return 100 * width / low;
}

double interocular_mean(double g) {
  return 2.304 + 0.510 * g;
}
// Least squares through the published table, which it leaves by at most 0.9 mm.
double binocular_mean(double g) {
  return -31.796 + 4.3235 * g - 0.053406 * g * g;
}
double facial_height_mean(double g) {
  return 37.8 * std::log(7 * g) - 161;
}
double zygomatic_mean(double g) {
  return 41.9 * std::log(7 * g) - 171.8;
}
double cheek_mean(double g) {
  return 1.95 * g - 9.08;
}
double philtrum_mean(double g) {
  return std::exp(2.778577 - 23.476723 / g);
}
double chin_mean(double g) {
  return std::exp(3.7922 - 28.043 / g);
}
// The table's 9.3 mm at 24 weeks breaks its sequence; 8.3 is taken.
double nasal_bone_mean(double g) {
  return of_table({6.7, 7.1, 7.5, 7.9, 8.3, 8.5, 8.9, 9.2, 9.8, 9.8, 10.0, 10.4, 10.5, 10.8, 10.9},
                  g);
}
double nasal_bone_spread(double g) {
  return of_table(
      {0.918, 1.07, 1.17, 0.995, 0.944, 1.15, 1.15, 1.17, 1.58, 1.3, 1.51, 1.35, 1.43, 1.12, 1.15},
      g);
}
// Least squares through the table of 20 to 28 weeks, continued.
double mandible_mean(double g) {
  return -18.0279 + 2.448420 * g - 0.01764069 * g * g;
}
double ear_mean(double g) {
  return 1.076 * g - 7.308;
}

std::array<FaceMeasureLaw, kFaceMeasures> make_laws() {
  constexpr auto absolute = Spread::absolute, relative = Spread::relative,
                 logarithmic = Spread::logarithmic;
  return {{
      {"head_circumference_mm",
       circumference_mean,
       circumference_spread,
       0,
       absolute,
       true,
       "around the skull's outer surface in the plane of BPD and OFD",
       "INTERGROWTH-21st (Papageorghiou, Lancet 2014)"},
      {"cephalic_index",
       cephalic_index_mean,
       constant<3600>,
       0,
       absolute,
       false,
       "100 BPD / OFD, outer to outer surface of the skull",
       "mean: INTERGROWTH-21st; spread: Constantine, n = 4304"},
      {"interocular_mm",
       interocular_mean,
       constant<1300>,
       0,
       absolute,
       true,
       "between the inner edges of the orbits",
       "Sukonpan 2008; spread from its R2"},
      {"binocular_mm",
       binocular_mean,
       constant<2300>,
       0,
       absolute,
       true,
       "between the outer edges of the orbits",
       "Mayden 1982, n = 180; spread from the R2 of Sukonpan 2008"},
      {"facial_height_mm",
       facial_height_mean,
       constant<2400>,
       1.1,
       absolute,
       true,
       "bone, nasion to gnathion, in the median plane",
       "den Boogert 2018; spread from its R2"},
      {"zygomatic_width_mm",
       zygomatic_mean,
       constant<93>,
       0.07,
       relative,
       true,
       "bone, between the most lateral points of the zygomatic bones",
       "den Boogert 2018; spread from its R2, as a share of the mean at 28 weeks; error assumed as "
       "of the jaw"},
      {"cheek_to_cheek_mm",
       cheek_mean,
       constant<117>,
       0.07,
       relative,
       true,
       "skin, widest between nostrils and lips, in the coronal plane 3 mm (at 21 weeks) behind "
       "subnasale",
       "Abramowicz 1991; spread from its R2, as a share of the mean at 30 weeks; error assumed as "
       "of the jaw"},
      {"philtrum_mm",
       philtrum_mean,
       constant<140>,
       0.07,
       logarithmic,
       true,
       "skin, base of the columella to the tip of the upper lip",
       "Gull 2005; spread from its R2, error assumed as of the jaw"},
      {"chin_mm",
       chin_mean,
       constant<140>,
       0.07,
       logarithmic,
       true,
       "skin, tip of the lower lip to the lowest point of the chin",
       "Gull 2005; spread from its R2, error assumed as of the jaw"},
      {"nasal_bone_mm",
       nasal_bone_mean,
       nasal_bone_spread,
       0,
       absolute,
       true,
       "from end to end of the nasal bone, in the median plane",
       "Sonek 2003, n = 3537"},
      {"prenasal_ratio",
       constant<680>,
       constant<97>,
       0.05,
       absolute,
       false,
       "shortest way from the lowest front edge of the frontal bone to the skin, over the nasal "
       "bone's length",
       "J Ultrasound Med 2013;32:795, n = 1922"},
      {"mandible_mm",
       mandible_mean,
       constant<95>,
       0.07,
       relative,
       true,
       "bone, front of the symphysis to the back of the angle, straight",
       "Chitty's table, 20 to 28 weeks, continued; spread from its printed range as that of 95 %"},
      {"ear_length_mm",
       ear_mean,
       constant<103>,
       0,
       relative,
       true,
       "skin, top of the helix to the lowest point of the lobe; mean of both ears",
       "Chitkara 2000, n = 2583; spread from its r, as a share of the mean at 27.5 weeks"},
      {"inferior_facial_angle_deg",
       constant<65500>,
       constant<6500>,
       4.6,
       absolute,
       false,
       "skin, between the perpendicular to the forehead and the line from the mentum that touches "
       "the more prominent lip",
       "Rotten 2002; spread between its 8.1 and the 5.1 of AJUM 2017;20:168; error: 7 %, as of the "
       "jaw"},
      {"nasomental_angle_deg",
       constant<146700>,
       constant<2700>,
       0,
       absolute,
       false,
       "skin, at the tip of the nose, between the tangents to forehead and chin",
       "Clin Exp Obstet Gynecol 2008;35:121, n = 81"},
      {"frontomaxillary_angle_deg",
       constant<83900>,
       constant<2800>,
       1.8,
       absolute,
       false,
       "bone, at the front of the maxilla, between the palate and the tangent to the frontal bone",
       "Molina 2008, n = 150; error from its repeatability"},
      {"ear_eye_angle_deg",
       constant<1260>,
       constant<3700>,
       0,
       absolute,
       false,
       "from the outer edge of the orbit to the middle of the ear, below the horizontal; mean of "
       "both sides",
       "doi 10.1055/s-0045-1812218, 40 ears; spread from their range"},
  }};
}

// Share of the published variance that is among fetuses, 0 to 1.
double reliability(const FaceMeasureLaw& law, double weeks) {
  const double spread = law.spread(weeks);
  return 1 - law.error * law.error / (spread * spread);
}

}  // namespace

double ellipse_perimeter(double diameter_a, double diameter_b) {
  const double difference = diameter_a - diameter_b, sum = diameter_a + diameter_b;
  const double h = difference * difference / (sum * sum);
  return kPi / 2 * sum * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)));
}

const std::array<FaceMeasureLaw, kFaceMeasures>& face_measure_laws() {
  static const std::array<FaceMeasureLaw, kFaceMeasures> laws = make_laws();
  return laws;
}

const FaceMeasureLaw& law_of(FaceMeasure measure) {
  return face_measure_laws()[static_cast<std::size_t>(measure)];
}

FaceMeasures mean_face(double weeks) {
  FaceMeasures mean;
  for (std::size_t i = 0; i < kFaceMeasures; ++i) {
    mean.values[i] = face_measure_laws()[i].mean(weeks);
  }
  return mean;
}

double true_spread(const FaceMeasureLaw& law, double weeks) {
  return law.spread(weeks) * std::sqrt(reliability(law, weeks));
}

double value_at(const FaceMeasureLaw& law, double weeks, double z) {
  const double mean = law.mean(weeks), spread = true_spread(law, weeks);
  switch (law.kind) {
    case Spread::relative:
      return mean * (1 + spread * z);
    case Spread::logarithmic:
      return mean * std::exp(spread * z);
    default:
      return mean + spread * z;
  }
}

double size_correlation(double weeks) {
  const double published = std::max(0.30 - 0.017 * (weeks - 18), 0.0);
  // The factor by which error dilutes the correlation of two sizes, averaged over all pairs.
  double sum = 0, squares = 0, count = 0;
  for (const FaceMeasureLaw& law : face_measure_laws()) {
    if (!law.is_size) continue;
    const double share = reliability(law, weeks);
    sum += std::sqrt(share);
    squares += share;
    ++count;
  }
  return published * count * (count - 1) / (sum * sum - squares);
}

}  // namespace wobblebench::phantoms
