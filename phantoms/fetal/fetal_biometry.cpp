#include "phantoms/fetal/fetal_biometry.h"
#include "base/units.h"

#include <cmath>

namespace wobblebench::phantoms {
namespace {

double second_diameter(double perimeter, double diameter) {
  double low = diameter, high = perimeter;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (ellipse_perimeter(diameter, middle) < perimeter ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double ellipse_perimeter(double diameter_a, double diameter_b) {
  const double difference = diameter_a - diameter_b, sum = diameter_a + diameter_b;
  const double h = difference * difference / (sum * sum);
  return kPi / 2 * sum * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h)));
}

FetalBiometry fetal_biometry(double gestational_age_weeks) {
  const double g = gestational_age_weeks, g2 = g * g;
  FetalBiometry b{};
  b.head_around_m = kMillimetre * (-28.2849 + 1.69267 * g2 - 0.397485 * g2 * std::log(g));
  b.biparietal_m = kMillimetre * (5.60878 + 0.158369 * g2 - 0.00256379 * g2 * g);
  b.occipitofrontal_m = second_diameter(b.head_around_m, b.biparietal_m);
  b.interocular_m = kMillimetre * (2.304 + 0.510 * g);
  b.binocular_m = kMillimetre * (2.590 + 1.420 * g);
  b.philtrum_m = kMillimetre * std::exp(2.778577 - 23.476723 / g);
  b.chin_m = kMillimetre * std::exp(3.7922 - 28.043 / g);
  return b;
}

}  // namespace wobblebench::phantoms
