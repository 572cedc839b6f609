#include <cmath>

#include "bench/report/validation/study_reports.h"
#include "sim/beam/beam_profile.h"
#include "sim/beam/point_spread.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kTolerance = 0.05;
/// Of `scatterers` against `reference` away from the foci.
constexpr double kUnfocused = 0.12;

struct Direction {
  const char* name;
  Profile PointResult::*profile;
  double (*formula_m)(const hw::AcquisitionPlan&, double);
};

double axial_m(const hw::AcquisitionPlan& plan, double) {
  return sim::axial_fwhm_m(plan);
}

double lateral_m(const hw::AcquisitionPlan& plan, double range_m) {
  return sim::BeamProfile(plan, {}).lateral_fwhm_m(range_m);
}
double elevation_m(const hw::AcquisitionPlan& plan, double range_m) {
  return sim::BeamProfile(plan, {}).elevation_fwhm_m(range_m);
}

const Direction kDirections[] = {{"axial", &PointResult::axial, axial_m},
                                 {"lateral", &PointResult::lateral, lateral_m},
                                 {"elevation", &PointResult::elevation, elevation_m}};

/// A rung with its results, in focus and with the foci of the default probe.
struct Variant {
  std::string name;
  sim::Rung rung;
  bool side_lobes;
  Mark mark;
  std::vector<PointResult> results;
  std::vector<PointResult> unfocused;
};

std::string in_mm(double metres) {
  return std::to_string(static_cast<int>(std::lround(metres * 1e3))) + " mm";
}

std::string check_name(const Variant& variant, const Direction& direction, double range_m) {
  return "points." + variant.name + "." + direction.name + "_at_" +
         std::to_string(std::lround(range_m * 1e3)) + "mm";
}

Check width_check(const std::string& name,
                  const Profile& profile,
                  double expected_m,
                  double tolerance,
                  const std::string& source) {
  return {name,
          Check::Kind::within,
          profile.fwhm_m * 1e3,
          expected_m * 1e3,
          tolerance * expected_m * 1e3,
          "mm",
          source,
          static_cast<long>(profile.offset_m.size()),
          "places",
          {}};
}

void add_checks(const Variant& variant, StudyReport& report) {
  for (const PointResult& result : variant.results) {
    for (const Direction& direction : kDirections) {
      const Profile& profile = result.*direction.profile;
      report.checks.push_back(
          width_check(check_name(variant, direction, result.range_m),
                      profile,
                      profile.formula_m,
                      kTolerance,
                      "full width at half maximum, both foci there, docs/references.md [4, 5]"));
    }
  }
}

void add_unfocused_checks(const Variant& variant, const Variant& reference, StudyReport& report) {
  for (std::size_t i = 0; i < variant.unfocused.size(); ++i) {
    const PointResult& result = variant.unfocused[i];
    for (const Direction& direction : kDirections) {
      report.checks.push_back(
          width_check(check_name(variant, direction, result.range_m) + ".default_foci",
                      result.*direction.profile,
                      (reference.unfocused[i].*direction.profile).fwhm_m,
                      kUnfocused,
                      "that of `reference`, foci at 75 mm"));
    }
  }
}

void add_points(const Variant& variant, StudyReport& report) {
  for (const PointResult& result : variant.results) {
    report.points.push_back({variant.name + " on the axis",
                             "range_mm",
                             result.range_m * 1e3,
                             "amplitude",
                             result.amplitude,
                             1.0});
    for (const Direction& direction : kDirections) {
      const Profile& profile = result.*direction.profile;
      const double sigma = sim::sigma_of_fwhm(profile.formula_m);
      for (std::size_t i = 0; i < profile.offset_m.size(); ++i) {
        const double u = profile.offset_m[i] / sigma;
        report.points.push_back({variant.name + " " + direction.name + " " + in_mm(result.range_m),
                                 "offset_mm",
                                 profile.offset_m[i] * 1e3,
                                 "amplitude",
                                 profile.amplitude[i],
                                 std::exp(-0.5 * u * u)});
      }
    }
  }
}

Picture3 draw_profiles(const Direction& direction, const std::vector<Variant>& variants) {
  Chart chart{std::string(direction.name) + " profile of one scatterer",
              {"offset (mm)"},
              {"amplitude / largest"}};
  const auto& first = variants.front().results;
  for (std::size_t depth = 0; depth < first.size(); ++depth) {
    const int colour = static_cast<int>(depth);
    const Profile& profile = first[depth].*direction.profile;
    Series formula{in_mm(first[depth].range_m) + ", formula"};
    formula.colour = colour;
    const double sigma = sim::sigma_of_fwhm(profile.formula_m);
    for (const double offset_m : profile.offset_m) {
      formula.x.push_back(offset_m * 1e3);
      formula.y.push_back(std::exp(-0.5 * offset_m * offset_m / sigma / sigma));
    }
    chart.series.push_back(formula);
    for (const Variant& variant : variants) {
      if (variant.side_lobes) continue;
      const Profile& found = variant.results[depth].*direction.profile;
      Series series{in_mm(first[depth].range_m) + ", " + variant.name,
                    {},
                    {},
                    Stroke::none,
                    variant.mark,
                    colour};
      for (std::size_t i = 0; i < found.offset_m.size(); i += 2) {
        series.x.push_back(found.offset_m[i] * 1e3);
        series.y.push_back(found.amplitude[i]);
      }
      chart.series.push_back(series);
    }
  }
  return draw(chart, {700, 380});
}

Picture3 draw_widths(const std::vector<Variant>& variants) {
  Chart chart{"Width of one scatterer's echo", {"range (mm)"}, {"full width at half maximum (mm)"}};
  chart.y.low = 0.0;
  const hw::AcquisitionPlan plan({}, {});
  for (int d = 0; d < 3; ++d) {
    const Direction& direction = kDirections[d];
    Series formula{std::string(direction.name) + ", formula"};
    formula.colour = d;
    for (int mm = 40; mm <= 120; ++mm) {
      const double r = 1e-3 * mm;
      formula.x.push_back(r * 1e3);
      formula.y.push_back(direction.formula_m(plan, r) * 1e3);
    }
    chart.series.push_back(formula);
  }
  for (const Variant& variant : variants) {
    for (int d = 0; d < 3; ++d) {
      Series series{d == 0 ? variant.name : "", {}, {}, Stroke::none, variant.mark, d};
      for (const PointResult& result : variant.unfocused) {
        series.x.push_back(result.range_m * 1e3);
        series.y.push_back((result.*kDirections[d].profile).fwhm_m * 1e3);
      }
      chart.series.push_back(series);
    }
  }
  return draw(chart, {700, 400});
}

}  // namespace

StudyReport point_target_report(const PointInputs& inputs) {
  StudyReport report;
  report.id = "points";
  report.title = "Point targets";
  std::vector<Variant> variants = {
      {"scatterers", sim::Rung::scatterers, false, Mark::disc, {}},
      {"scatterers_side_lobes", sim::Rung::scatterers, true, Mark::triangle, {}},
      {"reference", sim::Rung::reference, false, Mark::ring, {}}};
  for (Variant& variant : variants) {
    for (const double range_m : inputs.ranges_m) {
      variant.results.push_back(measure_point(variant.rung, range_m, variant.side_lobes, inputs));
    }
    PointInputs unfocused = inputs;
    unfocused.in_focus = false;
    for (const double range_m : inputs.ranges_m) {
      variant.unfocused.push_back(
          measure_point(variant.rung, range_m, variant.side_lobes, unfocused));
    }
    add_checks(variant, report);
    add_points(variant, report);
  }
  add_unfocused_checks(variants[0], variants[2], report);
  report.figures.push_back({"points_lateral",
                            "Echo of one scatterer against its offset in the image plane.",
                            draw_profiles(kDirections[1], variants)});
  report.figures.push_back({"points_elevation",
                            "The same across the image plane.",
                            draw_profiles(kDirections[2], variants)});
  report.figures.push_back(
      {"points_widths",
       "Widths at half maximum by the default probe, its foci at 75 mm; lines are the formulas.",
       draw_widths(variants)});
  report.text =
      "One scatterer in the open, on the axis of the probe, seen by sticks that turn past it: in "
      "the image plane, and about the motor's axis. It is heard by the rungs' own sums of echoes "
      "(`sim::ScattererField`, `sim::ReferenceScene`), with nothing else around. The formulas are "
      "those of `sim/beam/point_spread.h`. First both foci are put at the scatterer's depth, where "
      "the formulas are closed forms of diffraction, with the directivity of elements on a curved "
      "face in the lateral one. Then the foci stay at 75 mm, and `scatterers` is held against "
      "`reference`; the formulas, which `field` uses, are an approximation there.";
  return report;
}

}  // namespace wobblebench::bench
