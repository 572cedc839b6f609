#include "bench/studies/validate/losses/reflection.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/statistics.h"
#include "sim/fidelity.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::bench {

namespace {

constexpr double kCoarseVoxel_m = 2e-3;  // planes are exact at any voxel size
constexpr double kSpacing_m = 0.1e-3;
constexpr double kMargin_m = 5e-3;  // of the echo of a tilted plane, in range
constexpr double kWidestLobe_rad = 90 * kDegree;

/// The phantom plane of a material without backscatter: only its face echoes.
phantoms::Phantom bare_plane(double tilt_x_rad,
                             double tilt_y_rad,
                             double roughness,
                             const std::string& material_name) {
  const auto plane = phantoms::make_phantom({.name = "plane",
                                             .voxel_m = kCoarseVoxel_m,
                                             .tilt_x_rad = tilt_x_rad,
                                             .tilt_y_rad = tilt_y_rad});
  const phantoms::Material replacement = phantoms::material(material_name);
  auto materials = plane.materials();
  for (phantoms::Material& material : materials) {
    if (material.name == "soft_tissue") material = replacement;
    material.backscatter_db = sim::kZeroAmplitude_db;
    material.roughness = roughness;
  }
  // The new phantom shares the grids with `owner`, which it keeps alive.
  const auto owner = std::make_shared<const phantoms::Phantom>(plane);
  return {plane.name(),
          materials,
          plane.background(),
          plane.surfaces(),
          plane.region_of_interest(),
          plane.suggested_position_m(),
          {owner, &owner->grids()},
          plane.joint()};
}

sim::SimulationOptions interface_alone(sim::Rung rung, std::uint64_t seed) {
  auto options = bare_envelope(rung, seed);
  options.attenuation = false;
  options.transmission_loss = false;
  return options;
}

double lobe(double angle_rad, double width_rad) {
  const double relative = 2 * angle_rad / width_rad;  // -3 dB where it is 1
  return std::pow(2.0, -0.5 * relative * relative);
}

double largest_echo(const phantoms::Phantom& plane, double lobe_width_rad) {
  const double depth_m = 0.09;
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = depth_m,
                                  .sticks_per_frame = 1,
                                  .samples_per_stick = static_cast<int>(depth_m / kSpacing_m),
                                  .frames_per_volume = 1});
  auto options = interface_alone(sim::Rung::field, 1);
  options.specular_width_rad = lobe_width_rad;
  const auto volume = scan(phantoms::still_at(plane, plane.suggested_position_m()), plan, options);
  return gaussian_peak(volume.stick(0, 0)).value;
}

/// fresnel() from amniotic fluid into a material.
double from_fluid(const std::string& material_name, double angle_rad) {
  return fresnel(
      phantoms::material("amniotic_fluid"), phantoms::material(material_name), angle_rad);
}

/// A smooth plane, tilted about x for even `index`, about y for odd.
phantoms::Phantom tilted(double angle_rad, int index, const std::string& material_name) {
  const bool about_x = index % 2 == 0;
  return bare_plane(about_x ? angle_rad : 0, about_x ? 0 : -angle_rad, 0, material_name);
}

/// A smooth plane of a material at each of these angles; `measure` completes each point, which
/// expects |R|.
template <class Measure>
std::vector<AnglePoint> measure_tilted(const std::string& material_name,
                                       const std::vector<double>& angles_deg,
                                       const Measure& measure) {
  std::vector<AnglePoint> points;
  for (const double degrees : angles_deg) {
    const double angle = degrees * kDegree;
    const auto plane = tilted(angle, static_cast<int>(points.size()), material_name);
    AnglePoint point{angle, 0, std::abs(from_fluid(material_name, angle)), 1};
    measure(point, plane);
    points.push_back(point);
  }
  return points;
}

/// Angles come from the fan: in a narrow sector no aperture reaches the array's end, where echoes
/// are weaker.
constexpr double kDiffuseSector_rad = 30 * kDegree, kDiffuseFan_rad = 90 * kDegree;

double energy(const std::vector<double>& stick, double spacing_m) {
  double sum = 0;
  for (const double value : stick) sum += value * value * spacing_m;
  return sum;
}

/// Sticks of similar incidence on a rough plane: mean intensities of the echo.
struct AngleBin {
  Moments energy, expected, angle;

  void add(double cosine, double intensity) {
    const double angle_rad = std::acos(cosine);
    const double mean = std::abs(from_fluid("soft_tissue", angle_rad)) * cosine;
    energy.add(intensity);
    expected.add(4 / kPi * mean * mean);
    angle.add(angle_rad);
  }
  /// The mean of a Rayleigh envelope from its mean intensity.
  AnglePoint point() const {
    return {angle.mean(),
            std::sqrt(kPi / 4 * energy.mean()),
            std::sqrt(kPi / 4 * expected.mean()),
            static_cast<long>(energy.count)};
  }
};

}  // namespace

double fresnel(const phantoms::Material& before,
               const phantoms::Material& behind,
               double angle_rad) {
  const double sin_through = behind.sound_speed_m_s / before.sound_speed_m_s * std::sin(angle_rad);
  if (sin_through >= 1) return 1;
  const double in = behind.impedance_rayl * std::cos(angle_rad);
  const double through = before.impedance_rayl * std::cos(std::asin(sin_through));
  return (in - through) / (in + through);
}

std::vector<AnglePoint> measure_lobe(const ReflectionInputs& inputs) {
  const double width_rad = sim::SimulationOptions{}.specular_width_rad;
  return measure_tilted("soft_tissue", inputs.lobe_deg, [&](AnglePoint& point, auto& plane) {
    point.measured = largest_echo(plane, width_rad);
    point.expected *= lobe(point.angle_rad, width_rad);
  });
}

std::vector<AnglePoint> measure_fresnel(const ReflectionInputs& inputs) {
  return measure_tilted("cortical_bone", inputs.fresnel_deg, [](AnglePoint& point, auto& plane) {
    point.measured = largest_echo(plane, kWidestLobe_rad) / lobe(point.angle_rad, kWidestLobe_rad);
  });
}

std::vector<AnglePoint> measure_diffuse(sim::Rung rung, const ReflectionInputs& inputs) {
  const double depth_m = 0.105;  // ends before the back of the slab
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = depth_m,
                                  .sector_rad = kDiffuseSector_rad,
                                  .fan_rad = kDiffuseFan_rad,
                                  .sticks_per_frame = inputs.sticks,
                                  .samples_per_stick = static_cast<int>(depth_m / kSpacing_m),
                                  .frames_per_volume = inputs.frames});
  const auto plane = bare_plane(0, 0, 1, "soft_tissue");
  const glm::dvec3 face = plane.suggested_position_m();
  // Equivalent length of the pulse: its energy over its peak power.
  const double length_m = std::sqrt(kPi) * sim::sigma_of_fwhm(sim::axial_fwhm_m(plan));
  const double bin_rad = inputs.diffuse_bin_deg * kDegree;
  std::vector<AngleBin> bins;
  for (const std::uint64_t seed : inputs.seeds) {
    const Scan volume = scan(phantoms::still_at(plane, face), plan, interface_alone(rung, seed));
    for (int f = 0; f < inputs.frames; ++f) {
      for (int l = 0; l < inputs.sticks; ++l) {
        const auto ray = plan.geometry().stick(plan.theta_rad(l), plan.frame_phi_rad(f));
        const double cosine = ray.direction.z;
        if ((face.z - ray.origin.z) / cosine > depth_m - kMargin_m) continue;
        const auto bin = static_cast<std::size_t>(std::acos(cosine) / bin_rad);
        if (bin >= bins.size()) bins.resize(bin + 1);
        bins[bin].add(cosine, energy(volume.stick(f, l), plan.sample_spacing_m()) / length_m);
      }
    }
  }
  std::vector<AnglePoint> points;
  for (const AngleBin& bin : bins) {
    if (bin.energy.count >= 100) points.push_back(bin.point());
  }
  return points;
}

namespace {

constexpr double kLobeTolerance = 0.02;     // of the echo at normal incidence
constexpr double kFresnelTolerance = 0.02;  // of a perfect mirror
constexpr double kDiffuseTolerance_db = 1;

double amplitude_db(double amplitude) {
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
    report.point(series,
                 {"incidence_deg", point.angle_rad / kDegree},
                 {"amplitude", point.measured, point.expected});
  }
}

Series marks(const std::string& name,
             const std::vector<AnglePoint>& points,
             Mark mark,
             int colour) {
  Series series{name, {}, {}, Stroke::none, mark, colour};
  for (const AnglePoint& point : points) {
    series.add(point.angle_rad / kDegree, amplitude_db(point.measured));
  }
  return series;
}

template <class Model>
Series model(const std::string& name, double to_deg, int colour, const Model& amplitude) {
  Series series{name, {}, {}, Stroke::solid, Mark::none, colour};
  for (int i = 0; i <= 400; ++i) {
    const double degrees = to_deg * i / 400;
    series.add(degrees, amplitude_db(amplitude(degrees * kDegree)));
  }
  return series;
}

Chart lobe_chart(const std::vector<AnglePoint>& points) {
  Chart chart{"Smooth plane, specular lobe",
              {"angle of incidence (deg)"},
              {"largest echo (dB against a mirror)"}};
  const double width = sim::SimulationOptions{}.specular_width_rad;
  const auto echo = [&](double a) {
    return std::abs(from_fluid("soft_tissue", a)) * lobe(a, width);
  };
  chart.series = {model("|R| x lobe", 6, 6, echo), marks("field", points, Mark::disc, 0)};
  return chart;
}

Chart wide_chart(const std::vector<AnglePoint>& bone,
                 const std::vector<AnglePoint>& field,
                 const std::vector<AnglePoint>& scatterers) {
  Chart chart{"Bone's |R|, and a rough plane",
              {"angle of incidence (deg)"},
              {"amplitude (dB against a mirror)"}};
  const auto smooth = [](double a) { return from_fluid("cortical_bone", a); };
  const auto rough = [](double a) { return std::abs(from_fluid("soft_tissue", a)) * std::cos(a); };
  chart.series = {model("|R|, fluid to bone", 44, 1, smooth),
                  marks("field, bone", bone, Mark::square, 1),
                  model("|R| cos i, to tissue", 44, 6, rough),
                  marks("field, rough", field, Mark::disc, 0),
                  marks("scatterers, rough", scatterers, Mark::ring, 2)};
  return chart;
}

}  // namespace

StudyReport reflection_report() {
  const ReflectionInputs inputs;
  StudyReport report;
  const auto smooth = [&](const std::string& name,
                          const std::vector<AnglePoint>& points,
                          double tolerance,
                          const std::string& law) {
    const AnglePoint& at = worst(points, difference);
    report.check("reflection." + name)
        .within(at.measured, at.expected, tolerance, "of a mirror")
        .from(law + "; " + at_angle(at))
        .over(static_cast<long>(points.size()), "angles");
  };
  const auto lobe_points = measure_lobe(inputs);
  smooth("lobe", lobe_points, kLobeTolerance * lobe_points.front().expected, "|R| times the lobe");
  const auto bone = measure_fresnel(inputs);
  smooth("fresnel", bone, kFresnelTolerance, "|R| by impedance and angle");
  add_points("lobe", lobe_points, report);
  add_points("fresnel bone", bone, report);
  std::vector<std::vector<AnglePoint>> diffuse;
  for (const sim::Rung rung : {sim::Rung::field, sim::Rung::scatterers}) {
    diffuse.push_back(measure_diffuse(rung, inputs));
    const AnglePoint& furthest = worst(diffuse.back(), [](const AnglePoint& point) {
      return std::abs(amplitude_db(point.measured / point.expected));
    });
    report.check("reflection.diffuse." + sim::to_string(rung))
        .within(amplitude_db(furthest.measured),
                amplitude_db(furthest.expected),
                kDiffuseTolerance_db,
                "dB")
        .from("|R| cos i; " + at_angle(furthest))
        .over(furthest.n, "sticks", inputs.seeds);
    add_points("diffuse " + sim::to_string(rung), diffuse.back(), report);
  }
  report.figures.push_back(
      {"reflection",
       "Left: fluid to smooth soft tissue, a lobe of 3 degrees. Right: fluid to smooth bone with "
       "the lobe divided out, and fluid to rough soft tissue, the mean of its diffuse echo.",
       {lobe_chart(lobe_points), wide_chart(bone, diffuse[0], diffuse[1])}});
  report.text =
      "The phantom plane with nothing inside, no losses on the path. Specular: its face is smooth, "
      "it is tilted about x and y in turn, and the stick on the axis looks at it; the largest echo "
      "is that of one pulse. With bone the lobe is made as wide as options allow and divided out, "
      "which leaves Fresnel's |R| up to total reflection. Diffuse: the face is rough, all sticks "
      "of a volume look at it, each at its own angle; the energy of their echoes, over the length "
      "of a pulse, is the mean power of the sheet, however the beam's width spreads it in range.";
  return report;
}

}  // namespace wobblebench::bench
