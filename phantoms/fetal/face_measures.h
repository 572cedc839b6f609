// The measures of a fetal face that an identity is drawn by: their published laws by gestational
// age, and what they mean on the surface.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace wobblebench::phantoms {

/// In the order of face_measure_laws().
enum class FaceMeasure : std::size_t {
  head_circumference,
  cephalic_index,
  interocular,
  binocular,
  facial_height,
  zygomatic_width,
  cheek_to_cheek,
  philtrum,
  chin,
  nasal_bone,
  prenasal_ratio,
  mandible,
  ear_length,
  inferior_facial_angle,
  nasomental_angle,
  frontomaxillary_angle,
  ear_eye_angle,
};
inline constexpr std::size_t kFaceMeasures = 17;

/// One value for each measure, in the unit that ends its name: mm, degrees, or none for ratios.
struct FaceMeasures {
  std::array<double, kFaceMeasures> values{};

  double& operator[](FaceMeasure measure) { return values[static_cast<std::size_t>(measure)]; }
  double operator[](FaceMeasure measure) const { return values[static_cast<std::size_t>(measure)]; }
};

/// How a measure spreads among fetuses of one age.
enum class Spread {
  absolute,     ///< normal; standard deviation in the measure's unit
  relative,     ///< normal; standard deviation as a share of the mean
  logarithmic,  ///< log-normal about the mean; standard deviation of the logarithm
};

/// The law of one measure. `weeks`: gestational age, 20 to 34.
struct FaceMeasureLaw {
  std::string_view name;  ///< ends in the unit
  double (*mean)(double weeks);
  double (*spread)(double weeks);  ///< published standard deviation, as `kind` says
  double error;                    ///< that of measuring once, which `spread` includes
  Spread kind;
  /// A length that grows with the face, and so shares the common factor of size.
  bool is_size;
  /// What is measured on the finished surface.
  std::string_view definition;
  std::string_view source;
};

const std::array<FaceMeasureLaw, kFaceMeasures>& face_measure_laws();
const FaceMeasureLaw& law_of(FaceMeasure measure);

/// Perimeter of the ellipse with these two diameters (Ramanujan 1914; within 1e-9 here).
double ellipse_perimeter(double diameter_a, double diameter_b);

/// The mean of every measure at this age.
FaceMeasures mean_face(double weeks);

/// Standard deviation among fetuses: the published one without that of measuring, as `kind` says.
double true_spread(const FaceMeasureLaw& law, double weeks);

/// `z` standard deviations from the mean.
double value_at(const FaceMeasureLaw& law, double weeks, double z);

/// Common correlation of the true sizes. The published craniofacial variability index gives 0.30
/// at 18 weeks, falling by 0.017 a week, among sizes with their measuring error (Roelfsema 2007),
/// which dilutes it.
double size_correlation(double weeks);

}  // namespace wobblebench::phantoms
