#include "bench/studies/validate/validation.h"

#include <algorithm>
#include <exception>

#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "base/text.h"
#include "base/user_error.h"
#include "bench/studies/validate/clinical/clinical.h"
#include "bench/studies/validate/losses/attenuation.h"
#include "bench/studies/validate/losses/losses.h"
#include "bench/studies/validate/losses/reflection.h"
#include "bench/studies/validate/points/point_targets.h"
#include "bench/studies/validate/points/rung_agreement.h"
#include "bench/studies/validate/repeatability.h"
#include "bench/studies/validate/speckle/moving_tissue.h"
#include "bench/studies/validate/speckle/speckle_size.h"
#include "bench/studies/validate/speckle/speckle_statistics.h"

namespace wobblebench::bench {

namespace {

std::string four_digits(double value) {
  return significant(value, 4);
}

/// "1 to 10", "3", "none".
std::string seeds_text(const std::vector<std::uint64_t>& seeds) {
  if (seeds.empty()) return "none";
  if (seeds.size() == 1) return std::to_string(seeds.front());
  return std::to_string(seeds.front()) + " to " + std::to_string(seeds.back());
}

std::string expected_text(const Check& check) {
  switch (check.kind) {
    case Check::Kind::within:
      return four_digits(check.expected) + " ± " + four_digits(check.tolerance);
    case Check::Kind::at_least:
      return "≥ " + four_digits(check.expected);
    case Check::Kind::at_most:
      return "≤ " + four_digits(check.expected);
  }
  return "";
}

std::string unit_text(const Check& check) {
  return check.unit == "1" ? "" : " " + check.unit;
}

const char* outcome(const Check& check) {
  return check.passed() ? "passed" : "failed";
}

std::string summary_of(const Provenance& provenance) {
  return "Made by `wobblebench validate`; nothing on this page is written by hand. Commit " +
         provenance.commit + ", " + provenance.cpu + ", " + std::to_string(provenance.threads) +
         " threads. Every point is in `validation.csv`, every check in `report.json`. Of the beam "
         "and of speckle, expected values are the tables of `tests/yardstick`: a sum over the "
         "probe's elements in Python and NumPy, frequency by frequency, written apart from the "
         "simulator, with which it shares no code; its own tests hold it against closed forms. It "
         "is linear acoustics, as the simulator is: what both leave out is at the end. Other "
         "expected values are closed forms or published ones. Numbers in brackets are those of "
         "`docs/references.md`.";
}

std::string outcomes_of(const std::vector<StudyReport>& reports) {
  std::size_t count = 0;
  for (const auto& report : reports) count += report.checks.size();
  const int failed = failed_checks(reports);
  std::string text = std::to_string(count) + " checks, " +
                     std::to_string(count - static_cast<std::size_t>(failed)) + " passed, " +
                     std::to_string(failed) + " failed.";
  if (failed > 0) text += "\n\nFailed:\n\n";
  for (const auto& report : reports) {
    for (const Check& check : report.checks) {
      if (!check.passed()) text += "- `" + check.name + "`: " + describe(check) + "\n";
    }
  }
  return text;
}

Table checks_table(const StudyReport& report) {
  Table table{.name = report.id + "_checks",
              .columns = {{"check"},
                          {"expected_from", "expected from"},
                          {"measured"},
                          {"expected"},
                          {"n"},
                          {"seeds"},
                          {"outcome"}}};
  for (const Check& check : report.checks) {
    table.add({Cell::code(check.name),
               check.source,
               four_digits(check.measured) + unit_text(check),
               expected_text(check),
               std::to_string(check.n) + " " + check.of,
               seeds_text(check.seeds),
               outcome(check)});
  }
  return table;
}

void add_study(const StudyReport& report, Document& document) {
  document.add(Heading{report.title}).add(Text{report.text});
  for (const Table& table : report.tables) document.add(table);
  if (!report.checks.empty()) document.add(checks_table(report));
  for (const Figure& figure : report.figures) document.add(figure);
}

/// Every point of every study.
Table points_table(const std::vector<StudyReport>& reports) {
  Table table{
      .name = "points",
      .columns = {{"study"}, {"series"}, {"x_name"}, {"x"}, {"y_name"}, {"y"}, {"expected"}}};
  for (const auto& report : reports) {
    for (const DataPoint& point : report.points) {
      table.add({report.id,
                 point.series,
                 point.x_name,
                 point.x,
                 point.y_name,
                 point.y,
                 point.expected ? Cell(*point.expected) : Cell()});
    }
  }
  return table;
}

constexpr char kNotModelled[] =
    R"(Neither the simulator nor the yardstick has these. What leaving each out does to the picture:

- Refraction: sound goes straight on at interfaces. Bodies behind a lens of other sound speed, as fat beside muscle or a curved skull, are neither shifted nor doubled sideways, and the edge shadows of cysts and skulls are missing (Robinson, Wilson, Kossoff, J. Clin. Ultrasound 9, 181 (1981)).
- Reverberation between two layers, neither of which is the probe's face: no repeated lines within bone or behind gas. The face's own (`simulation.clutter.probe_reflection`) and a floor of other clutter (`haze_db`) are options, off by default (Pinton, Trahey, Dahl, IEEE Trans. UFFC 58, 754 (2011)).
- Sound that takes several scatterers, and side lobes on the rung `field`, by themselves: haze has their level and their surroundings, not their phases; its speckle stays with the probe while what causes it moves.
- Aberration by layers of varying sound speed, as of the abdominal wall: beams stay as sharp, and side lobes as low, as in uniform tissue; real ones are wider (Hinkelman et al., J. Acoust. Soc. Am. 95, 530 (1994)).
- Harmonics of non-linear propagation: no harmonic imaging, with its lower side lobes and less clutter near the face; echoes are the fundamental's at any pressure (Averkiou, Roundhill, Powers, IEEE Ultrasonics Symp. 1997, 1561).
- Focal gain: a machine's depth gain lifts what the beam weakens away from its focus (tissue by 15 dB at 20 mm and 9 dB at 150 mm), and noise with it. Here uniform tissue has the same echo at every range, a point on the axis its own, and noise before time gain is the same at every range: it is too low away from the focus.
- Shear waves in bone: beyond the critical angle of longitudinal waves nothing passes, where in truth a part passes as shear waves, so that shadows of slanted bone are too dark (Clement, White, Hynynen, J. Acoust. Soc. Am. 115, 1356 (2004)).
- Cross-talk between elements, and the obliquity factor of a baffle: elements are as directive as their width makes them; off an element's axis real ones are weaker (Selfridge, Kino, Khuri-Yakub, Appl. Phys. Lett. 37, 35 (1980)).
)";

}  // namespace

const std::vector<NamedStudy>& validation_studies() {
  static const std::vector<NamedStudy> studies = {
      {"speckle", "Speckle statistics", 50, speckle_statistics_report},
      {"density", "Speckle against scatterers per resolution cell", 23, scatterer_density_report},
      {"points", "Point targets", 23, point_target_report},
      {"agreement", "Echoes of many points", 2.4, rung_agreement_report},
      {"speckle_size", "Size of speckle", 280, speckle_size_report},
      {"speckle_motion", "Speckle moves with the tissue", 0.3, speckle_motion_report},
      {"attenuation", "Attenuation, shadow, enhancement", 3, attenuation_report},
      {"losses", "Losses over the band and over the aperture", 5, losses_report},
      {"reflection", "Reflection against angle", 3.3, reflection_report},
      {"shear", "A moving sphere is sheared", 0.2, shear_report},
      {"clinical", "Samples of the preset clinical", 25, clinical_report},
      {"repeatability", "A seed means one set of bytes", 55, repeatability_report}};
  return studies;
}

StudyReport run_study(const NamedStudy& study) {
  StudyReport report;
  try {
    report = study.run();
    report.title = study.title;
  } catch (const std::exception& error) {
    report.title = study.id;
    report.text = "This study could not be run: " + one_line(error.what());
    report.check(study.id + ".ran").at_least(0, 1, "1").from(one_line(error.what())).over(1, "run");
  }
  report.id = study.id;
  return report;
}

int failed_checks(const std::vector<StudyReport>& reports) {
  int failed = 0;
  for (const auto& report : reports) {
    failed += static_cast<int>(std::count_if(report.checks.begin(),
                                             report.checks.end(),
                                             [](const Check& check) { return !check.passed(); }));
  }
  return failed;
}

std::string describe(const Check& check) {
  return four_digits(check.measured) + unit_text(check) + "; expected " + expected_text(check) +
         unit_text(check) + " (" + check.source + "); n = " + std::to_string(check.n) + " " +
         check.of + "; seeds " + seeds_text(check.seeds);
}

Document validation_document(const std::vector<StudyReport>& reports,
                             const Provenance& provenance) {
  Document document{.title = "Validation of the simulated probe", .name = "validation"};
  document.add(Text{summary_of(provenance)}).add(Text{outcomes_of(reports)});
  for (const auto& report : reports) add_study(report, document);
  document.add(Heading{"Not modelled"}).add(Text{kNotModelled});
  document.data = {{"validation.csv", points_table(reports)}};
  return document;
}

nlohmann::ordered_json checks_json(const std::vector<StudyReport>& reports) {
  auto checks = nlohmann::ordered_json::array();
  for (const auto& report : reports) {
    for (const Check& check : report.checks) {
      checks.push_back(
          {{"name", check.name}, {"outcome", outcome(check)}, {"detail", describe(check)}});
    }
  }
  return checks;
}

}  // namespace wobblebench::bench
