#include "bench/studies/fit/fit_report.h"

#include <cmath>
#include <sstream>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

/// Larger ratios are rounding.
constexpr double kMostRatio = 1000;

/// A parameter's unit in reports, and its number in one SI unit.
struct ShownUnit {
  const char* name;
  const char* unit;
  double per_si;
};

/// By RegistrationParameter.
constexpr ShownUnit kShown[kRegistrationParameters] = {
    {"rotation x", "deg", 1 / kDegree},
    {"rotation y", "deg", 1 / kDegree},
    {"rotation z", "deg", 1 / kDegree},
    {"translation x", "mm", 1e3},
    {"translation y", "mm", 1e3},
    {"translation z", "mm", 1e3},
    {"speed of sound, true over assumed less 1", "%", 100},
    {"bias along the ray", "mm", 1e3},
    {"motor angle offset", "deg", 1 / kDegree},
    {"wobble radius", "mm", 1e3}};

std::string in_unit(int parameter, double value) {
  return std::isfinite(value) ? fixed(value * kShown[parameter].per_si, 3) : "none";
}

void write_registration(const Registration& fit, std::ostream& text) {
  text << fit.points << " points in " << fit.blocks << " blocks of "
       << fixed(kErrorBlock_m / kMillimetre, 0) << " mm; RMS distance "
       << fixed(fit.rms_before_m / kMillimetre, 2) << " mm before, "
       << fixed(fit.rms_after_m / kMillimetre, 2)
       << " mm after. By blocks a variance is on average " << fixed(fit.variance_inflation, 1)
       << " times what it would be by points.\n\n"
       << "| parameter | value | 95 % interval |\n| --- | ---: | ---: |\n";
  for (int i = 0; i < kRegistrationParameters; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    if (fit.low[slot] == fit.high[slot]) continue;  // held
    text << "| " << kShown[i].name << ", " << kShown[i].unit << " | " << in_unit(i, fit.value[slot])
         << " | " << in_unit(i, fit.low[slot]) << " to " << in_unit(i, fit.high[slot]) << " |\n";
  }
  text << "\n";
  for (const auto& [parameters, ratio] : fit.unseen) {
    text << "Not told apart by this scene:";
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      text << (i ? ", " : " ") << kShown[parameters[i]].name;
    }
    text << " (deviation of the combination from the data alone: "
         << (ratio < kMostRatio ? fixed(ratio, 1) : "more than 1000") << " times its prior's).\n";
  }
  for (const auto& [one, other] : fit.correlated) {
    text << "Correlated by " << fixed(fit.correlation(one, other), 3) << ": " << kShown[one].name
         << " and " << kShown[other].name << ".\n";
  }
}

void write_coverage(const Coverage& coverage, std::ostream& text) {
  text
      << "\n## Planted errors\n\nAll four at once in the true probe of each of "
      << coverage.seeds.size()
      << " seeds, registered with the assumed one, the pose known. What is fitted is what differs, "
         "pixel by pixel, from the mean of "
      << coverage.reference.size()
      << " other seeds without planted errors: of their distances to the surface, "
      << fixed(coverage.repeatable_rms_m / kMillimetre, 3)
      << " mm (RMS) is the same in every seed and cancels, "
      << fixed(coverage.random_rms_m / kMillimetre, 3)
      << " mm is not. Nothing planted: each of those seeds against the mean of the others.\n\n"
         "| parameter | planted | recovered, mean | deviation over seeds | half width of the 95 % "
         "interval, mean | in the interval | nothing planted: 0 in the interval |\n"
         "| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const PlantedParameter& row : coverage.parameters) {
    const int p = row.parameter;
    text << "| " << kShown[p].name << ", " << kShown[p].unit << " | " << in_unit(p, row.planted)
         << " | " << in_unit(p, row.mean) << " | " << in_unit(p, row.deviation) << " | "
         << in_unit(p, row.half_width) << " | " << row.covered << " of " << coverage.seeds.size()
         << " | " << row.held_nothing << " of " << coverage.reference.size() << " |\n";
  }
}

template <std::size_t N>
void write_terms(const std::array<FittedTerm, N>& terms,
                 const std::array<TermDescription, N>& descriptions,
                 std::ostream& text) {
  text
      << "\n| term | unit | value | 95 % interval | meaning |\n| --- | --- | ---: | ---: | --- |\n";
  for (std::size_t i = 0; i < N; ++i) {
    text << "| " << descriptions[i].name << " | " << descriptions[i].unit << " | ";
    if (terms[i].fitted) {
      text << fixed(terms[i].value, 4) << " | " << fixed(terms[i].low, 4) << " to "
           << fixed(terms[i].high, 4);
    } else {
      text << "not taken | ";
    }
    text << " | " << descriptions[i].meaning << " |\n";
  }
}

void write_judgement(const Judgement& judged, std::ostream& text) {
  const auto share = [](double value) {
    return std::isfinite(value) ? fixed(100 * value, 1) : std::string("none");
  };
  text << "| " << judged.name << " | " << judged.rung << " | " << judged.pixels << " | "
       << fixed(judged.mean_before_mm, 2) << " → " << fixed(judged.mean_after_mm, 2) << " | "
       << fixed(judged.rms_before_mm, 2) << " → " << fixed(judged.rms_after_mm, 2) << " | "
       << share(judged.explained_variance) << " | " << share(judged.reproducible_variance) << " | "
       << share(judged.explained_of_reproducible()) << " | " << fixed(judged.within_one_percent, 1)
       << ", " << fixed(judged.within_two_percent, 1) << " |\n";
}

void write_choice(const TermChoice& choice, std::ostream& text) {
  text << "\nTerms taken by cross-validation over " << choice.folds
       << " folds of the training scans (each set, and each phantom with several sets, held out in "
          "turn), with the mean square that is left, mean over folds:";
  for (const ChosenTerm& chosen : choice.order) {
    text << (&chosen == &choice.order.front() ? " " : ", ") << error_terms().at(chosen.term).name
         << " " << fixed(100 * chosen.left, 1) << " %";
  }
  text << (choice.order.empty() ? " none; nothing is better than no correction.\n" : ".\n");
}

void write_effects(const ModelStudy& study, std::ostream& text) {
  text
      << "\n## Correction of held-out pictures\n\nFound → corrected, means over seeds; RMS outside "
         "the band at silhouettes; missed and false do not change.\n\n"
         "| scans | rung | median, mm | P95, mm | RMS, mm | missed, % | false, % |\n"
         "| --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
  const auto pair = [](double before, double after) {
    return fixed(before, 2) + " → " + fixed(after, 2);
  };
  for (const Judgement& judged : study.held_out) {
    const PictureEffect &found = judged.found, &corrected = judged.corrected;
    text << "| " << judged.name << " | " << judged.rung << " | "
         << pair(found.median_mm, corrected.median_mm) << " | "
         << pair(found.p95_mm, corrected.p95_mm) << " | "
         << pair(found.outside_rms_mm, corrected.outside_rms_mm) << " | "
         << fixed(found.missed_percent, 2) << " | " << fixed(found.false_percent, 2) << " |\n";
  }
}

void write_model(const ModelStudy& study, std::ostream& text) {
  text << "\n## Detection error\n\nMean and spread of the error along the pixel's ray, found less "
          "true, from "
       << study.model.rows << " pixels of " << study.training_scans
       << " scans; intervals by bootstrap of " << study.model.blocks
       << " blocks, one for all seeds at a place. Pixels more than "
       << fixed(kOtherSurface_m / kMillimetre, 0)
       << " mm off show another surface and are left out.\n";
  write_choice(study.choice, text);
  write_terms(study.model.bias, error_terms(), text);
  text << "\nLogarithm of the spread in mm:\n";
  write_terms(study.model.spread, spread_term_descriptions(), text);
  for (const auto& [one, other] : study.model.correlated) {
    text << "\nCorrelated by more than 0.95: "
         << error_terms().at(static_cast<std::size_t>(one)).name << " and "
         << error_terms().at(static_cast<std::size_t>(other)).name << ".\n";
  }
  text << "\n| scans | rung | pixels | mean error, mm | RMS, mm | variance explained, % | the same "
          "in "
          "two seeds, % | explained of that, % | within one, two spreads, % (normal: 68.3, 95.4) "
          "|\n| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  write_judgement(study.training, text);
  for (const Judgement& judged : study.held_out) write_judgement(judged, text);
  write_judgement(study.all_held_out, text);
  write_effects(study, text);
}

}  // namespace

std::string fit_markdown(const FitResults& results, const Provenance& provenance) {
  std::ostringstream text;
  text << "# Fit\n\nMade by `wobblebench fit`. Commit " << provenance.commit << ", "
       << provenance.cpu << ", " << provenance.gl_renderer
       << ".\n\n## Registration, the pose known\n\n";
  write_registration(results.known_pose, text);
  text << "\n## Registration, nothing known\n\n";
  write_registration(results.nothing_known, text);
  if (results.coverage) write_coverage(*results.coverage, text);
  write_model(results.model, text);
  text << "\n`correction.json` holds the model; `run --set render.correction=FILE` applies it.\n";
  for (const Figure& figure : fit_figures(results.model)) {
    text << "\n[Chart: " << figure.caption << "](fit_" << figure.name << ".vl.json)\n";
  }
  for (const NamedPicture& picture : residual_pictures(results.model)) {
    text << "\n![" << picture.caption << "](" << picture.file << ")\n";
  }
  return text.str();
}

}  // namespace wobblebench::bench
