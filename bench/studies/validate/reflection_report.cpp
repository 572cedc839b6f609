#include <algorithm>
#include <cmath>

#include "bench/studies/validate/study_reports.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kLobeTolerance = 0.02;     // of the echo at normal incidence
constexpr double kFresnelTolerance = 0.02;  // of a perfect mirror
constexpr double kDiffuseTolerance_db = 1;

double db(double amplitude) {
  return 20 * std::log10(amplitude);
}

/// The point of the largest distance.
template <class Distance>
const AnglePoint& worst(const std::vector<AnglePoint>& points, const Distance& distance) {
  return *std::max_element(points.begin(), points.end(), [&](const auto& a, const auto& b) {
    return distance(a) < distance(b);
  });
}

double difference(const AnglePoint& point) {
  return std::abs(point.measured - point.expected);
}

std::string at_angle(const AnglePoint& point) {
  return "worst of all angles, at " + std::to_string(std::lround(point.angle_rad / kDegree)) +
         " degrees";
}

void add_points(const std::string& series,
                const std::vector<AnglePoint>& points,
                StudyReport& report) {
  for (const AnglePoint& point : points) {
    report.points.push_back({series,
                             "incidence_deg",
                             point.angle_rad / kDegree,
                             "amplitude",
                             point.measured,
                             point.expected});
  }
}

Series marks(const std::string& name,
             const std::vector<AnglePoint>& points,
             Mark mark,
             int colour) {
  Series series{name, {}, {}, Stroke::none, mark, colour};
  for (const AnglePoint& point : points) {
    series.x.push_back(point.angle_rad / kDegree);
    series.y.push_back(db(point.measured));
  }
  return series;
}

template <class Model>
Series model(const std::string& name, double to_deg, int colour, const Model& amplitude) {
  Series series{name, {}, {}, Stroke::solid, Mark::none, colour};
  for (int i = 0; i <= 400; ++i) {
    const double degrees = to_deg * i / 400;
    series.x.push_back(degrees);
    series.y.push_back(db(amplitude(degrees * kDegree)));
  }
  return series;
}

Picture3 draw_lobe(const std::vector<AnglePoint>& points) {
  Chart chart{"Smooth plane, specular lobe",
              {"angle of incidence (deg)"},
              {"largest echo (dB against a mirror)"}};
  const auto& fluid = phantoms::material("amniotic_fluid");
  const auto& tissue = phantoms::material("soft_tissue");
  const double width = sim::SimulationOptions{}.specular_width_rad;
  chart.series = {model("|R| x lobe",
                        6,
                        6,
                        [&](double angle) {
                          const double relative = 2 * angle / width;
                          return std::abs(fresnel(fluid, tissue, angle)) *
                                 std::pow(2.0, -0.5 * relative * relative);
                        }),
                  marks("field", points, Mark::disc, 0)};
  return draw(chart, {560, 360});
}

Picture3 draw_wide(const std::vector<AnglePoint>& bone,
                   const std::vector<AnglePoint>& field,
                   const std::vector<AnglePoint>& scatterers) {
  Chart chart{"Bone's |R|, and a rough plane",
              {"angle of incidence (deg)"},
              {"amplitude (dB against a mirror)"}};
  const auto& fluid = phantoms::material("amniotic_fluid");
  const auto& tissue = phantoms::material("soft_tissue");
  const auto& hard = phantoms::material("cortical_bone");
  chart.series = {
      model("|R|, fluid to bone", 44, 1, [&](double a) { return fresnel(fluid, hard, a); }),
      marks("field, bone", bone, Mark::square, 1),
      model("|R| cos i, to tissue",
            44,
            6,
            [&](double a) { return std::abs(fresnel(fluid, tissue, a)) * std::cos(a); }),
      marks("field, rough", field, Mark::disc, 0),
      marks("scatterers, rough", scatterers, Mark::ring, 2)};
  return draw(chart, {640, 360});
}

}  // namespace

StudyReport reflection_report(const ReflectionInputs& inputs) {
  StudyReport report;
  report.id = "reflection";
  report.title = "Reflection against angle";
  const auto lobe_points = measure_lobe(inputs);
  const AnglePoint& lobe_worst = worst(lobe_points, difference);
  report.checks.push_back({"reflection.lobe",
                           Check::Kind::within,
                           lobe_worst.measured,
                           lobe_worst.expected,
                           kLobeTolerance * lobe_points.front().expected,
                           "of a mirror",
                           "|R| times the lobe; " + at_angle(lobe_worst),
                           static_cast<long>(lobe_points.size()),
                           "angles",
                           {}});
  const auto bone = measure_fresnel(inputs);
  const AnglePoint& bone_worst = worst(bone, difference);
  report.checks.push_back({"reflection.fresnel",
                           Check::Kind::within,
                           bone_worst.measured,
                           bone_worst.expected,
                           kFresnelTolerance,
                           "of a mirror",
                           "|R| by impedance and angle; " + at_angle(bone_worst),
                           static_cast<long>(bone.size()),
                           "angles",
                           {}});
  add_points("lobe", lobe_points, report);
  add_points("fresnel bone", bone, report);
  std::vector<std::vector<AnglePoint>> diffuse;
  for (const sim::Rung rung : {sim::Rung::field, sim::Rung::scatterers}) {
    diffuse.push_back(measure_diffuse(rung, inputs));
    const AnglePoint& furthest = worst(diffuse.back(), [](const AnglePoint& point) {
      return std::abs(db(point.measured / point.expected));
    });
    report.checks.push_back({"reflection.diffuse." + sim::to_string(rung),
                             Check::Kind::within,
                             db(furthest.measured),
                             db(furthest.expected),
                             kDiffuseTolerance_db,
                             "dB",
                             "|R| cos i; " + at_angle(furthest),
                             furthest.n,
                             "sticks",
                             inputs.seeds});
    add_points("diffuse " + sim::to_string(rung), diffuse.back(), report);
  }
  report.figures.push_back(
      {"reflection",
       "Left: fluid to smooth soft tissue, a lobe of 3 degrees. Right: fluid to smooth bone with "
       "the lobe divided out, and fluid to rough soft tissue, the mean of its diffuse echo.",
       side_by_side({draw_lobe(lobe_points), draw_wide(bone, diffuse[0], diffuse[1])})});
  report.text =
      "The phantom plane with nothing inside, no losses on the way. Specular: its face is smooth, "
      "it is tilted about x and y in turn, and the stick on the axis looks at it; the largest echo "
      "is that of one pulse. With bone the lobe is made as wide as options allow and divided out, "
      "which leaves Fresnel's |R| up to total reflection. Diffuse: the face is rough, all sticks "
      "of a volume look at it, each at its own angle; the energy of their echoes, over the length "
      "of a pulse, is the mean power of the sheet, however the beam's width spreads it in range.";
  return report;
}

}  // namespace wobblebench::bench
