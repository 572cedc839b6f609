#include "bench/studies/fit/fit_report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/number_text.h"
#include "bench/output/report.h"
#include "bench/results/error.h"

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

double in_unit(int parameter, double value) {
  return value * kShown[parameter].per_si;
}

std::string parameter_name(int parameter) {
  return std::string(kShown[parameter].name) + ", " + kShown[parameter].unit;
}

const char* term_name(int term) {
  return error_terms().at(static_cast<std::size_t>(term)).name;
}

Table parameters_table(const Registration& fit, const std::string& name) {
  Table table{.name = name, .columns = {{"parameter"}, {"value", "value (95 % interval)", "", 3}}};
  for (int i = 0; i < kRegistrationParameters; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    if (fit.low[slot] == fit.high[slot]) continue;  // held
    table.add(
        {parameter_name(i),
         Cell::spread(
             in_unit(i, fit.value[slot]), in_unit(i, fit.low[slot]), in_unit(i, fit.high[slot]))});
  }
  return table;
}

/// Parameters that the scene does not tell apart, or hardly.
std::string weaknesses_of(const Registration& fit) {
  std::string text;
  for (const auto& [parameters, ratio] : fit.unseen) {
    text += "- Not told apart by this scene:";
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      text.append(i > 0 ? ", " : " ").append(kShown[parameters[i]].name);
    }
    text += " (deviation of the combination from the data alone: " +
            (ratio < kMostRatio ? fixed(ratio, 1) : std::string("more than 1000")) +
            " times its prior's).\n";
  }
  for (const auto& [one, other] : fit.correlated) {
    text += "- Correlated by " + fixed(fit.correlation(one, other), 3) + ": " + kShown[one].name +
            " and " + kShown[other].name + ".\n";
  }
  return text;
}

void add_registration(const Registration& fit,
                      const std::string& title,
                      const std::string& name,
                      Document& document) {
  document.add(Heading{title});
  document.add(Text{std::to_string(fit.points) + " points in " + std::to_string(fit.blocks) +
                    " blocks of " + fixed(kErrorBlock_m / kMillimetre, 0) + " mm; RMS distance " +
                    fixed(fit.rms_before_m / kMillimetre, 2) + " mm before, " +
                    fixed(fit.rms_after_m / kMillimetre, 2) +
                    " mm after. By blocks a variance is on average " +
                    fixed(fit.variance_inflation, 1) + " times what it would be by points."});
  document.add(parameters_table(fit, name));
  const std::string weaknesses = weaknesses_of(fit);
  if (!weaknesses.empty()) document.add(Text{weaknesses});
}

Table coverage_table(const Coverage& coverage) {
  const std::string planted_seeds = " of " + std::to_string(coverage.seeds.size());
  const std::string reference_seeds = " of " + std::to_string(coverage.reference.size());
  using P = PlantedParameter;
  const auto in_units = [](double P::*of) {
    return [of](const P& row) { return in_unit(row.parameter, row.*of); };
  };
  return table_of<P>(
      {.name = "coverage"},
      coverage.parameters,
      {{{"parameter"}, [](const P& row) { return parameter_name(row.parameter); }},
       {{"planted", "", "", 3}, in_units(&P::planted)},
       {{"mean_recovered", "recovered, mean", "", 3}, in_units(&P::mean)},
       {{"standard_deviation", "deviation over seeds", "", 3}, in_units(&P::deviation)},
       {{"mean_half_width", "half width of the 95 % interval, mean", "", 3},
        in_units(&P::half_width)},
       {{"covered", "in the interval," + planted_seeds}, &P::covered},
       {{"held_nothing", "nothing planted: 0 in the interval," + reference_seeds},
        &P::held_nothing}});
}

/// A row for each seed and parameter, in SI units.
Table planted_table(const Coverage& coverage) {
  Table table{.name = "planted",
              .columns = {{"scan"}, {"seed"}, {"parameter"}, {"planted"}, {"value"}}};
  const auto add = [&](const char* scan, const PlantedSeed& fitted, bool planted) {
    for (const PlantedParameter& row : coverage.parameters) {
      const auto slot = static_cast<std::size_t>(row.parameter);
      table.add(
          {scan,
           fitted.seed,
           registration_names()[slot],
           planted ? row.planted : 0.0,
           Cell::spread(fitted.fit.value[slot], fitted.fit.low[slot], fitted.fit.high[slot])});
    }
  };
  for (const PlantedSeed& fitted : coverage.reference) add("reference", fitted, false);
  for (const PlantedSeed& fitted : coverage.seeds) add("planted", fitted, true);
  return table;
}

void add_coverage(const Coverage& coverage, Document& document) {
  document.add(Heading{"Planted errors"});
  document.add(Text{
      "All four at once in the true probe of each of " + std::to_string(coverage.seeds.size()) +
      " seeds, registered with the assumed one, the pose known. What is fitted is what differs, "
      "pixel by pixel, from the mean of " +
      std::to_string(coverage.reference.size()) +
      " other seeds without planted errors: of their distances to the surface, " +
      fixed(coverage.repeatable_rms_m / kMillimetre, 3) +
      " mm (RMS) is the same in every seed and cancels, " +
      fixed(coverage.random_rms_m / kMillimetre, 3) +
      " mm is not. Nothing planted: each of those seeds against the mean of the others."});
  document.add(coverage_table(coverage));
  document.data.push_back({"fit_coverage.csv", planted_table(coverage)});
}

template <std::size_t N>
void add_terms(const char* part,
               const std::array<FittedTerm, N>& terms,
               const std::array<TermDescription, N>& descriptions,
               Table& table) {
  for (std::size_t i = 0; i < N; ++i) {
    const FittedTerm& term = terms[i];
    table.add({part,
               descriptions[i].name,
               descriptions[i].unit,
               term.fitted ? Cell::spread(term.value, term.low, term.high) : Cell(),
               descriptions[i].meaning});
  }
}

Table terms_table(const DetectionModel& model) {
  Table table{
      .name = "terms",
      .caption =
          "Terms of the bias and of the logarithm of the spread in mm; without a "
          "value: not taken",
      .columns = {
          {"part"}, {"term"}, {"unit"}, {"value", "value (95 % interval)", "", 4}, {"meaning"}}};
  add_terms("bias", model.bias, error_terms(), table);
  add_terms("spread", model.spread, spread_term_descriptions(), table);
  return table;
}

/// Means of the held-out residuals, a row for each bin.
Table residuals_table(const ModelStudy& study) {
  using B = ResidualBin;
  return table_of<B>({.name = "residuals"},
                     study.bins,
                     {{{"quantity"}, &B::quantity},
                      {{"at"}, &B::at},
                      {{"pixels"}, &B::pixels},
                      {{"mean_error_before_mm"}, &B::before_mm},
                      {{"mean_error_after_mm"}, &B::after_mm}});
}

std::vector<Judgement> all_judgements(const ModelStudy& study) {
  std::vector<Judgement> all = {study.training};
  all.insert(all.end(), study.held_out.begin(), study.held_out.end());
  all.push_back(study.all_held_out);
  return all;
}

/// The figures of a judgement.
const std::vector<Field<Judgement>>& judgement_columns() {
  using J = const Judgement&;
  static const std::vector<Field<Judgement>> columns = {
      {{"other_surface_percent", "other surface", "%", 1}, &Judgement::other_surface_percent},
      {{"mean_before_mm", "mean error, found", "mm"}, &Judgement::mean_before_mm},
      {{"mean_after_mm", "mean error, corrected", "mm"}, &Judgement::mean_after_mm},
      {{"rms_before_mm", "RMS, found", "mm"}, &Judgement::rms_before_mm},
      {{"rms_after_mm", "RMS, corrected", "mm"}, &Judgement::rms_after_mm},
      {{"explained_variance", "share of the variance explained", "", 3},
       &Judgement::explained_variance},
      {{"removed_mean_square", "share of the mean square removed", "", 3},
       &Judgement::removed_mean_square},
      {{"reproducible_variance", "the same in two seeds", "", 3},
       &Judgement::reproducible_variance},
      {{"within_one_spread_percent", "within one spread (normal: 68.3)", "%", 1},
       &Judgement::within_one_percent},
      {{"within_two_spreads_percent", "within two (95.4)", "%", 1}, &Judgement::within_two_percent},
      {{"explained_of_reproducible", "explained of that", "", 3},
       &Judgement::explained_of_reproducible},
      {{"median_before_mm", "median, found", "mm"}, [](J j) { return j.found.median_mm; }},
      {{"median_after_mm", "median, corrected", "mm"}, [](J j) { return j.corrected.median_mm; }},
      {{"p95_before_mm", "P95, found", "mm"}, [](J j) { return j.found.p95_mm; }},
      {{"p95_after_mm", "P95, corrected", "mm"}, [](J j) { return j.corrected.p95_mm; }},
      {{"outside_rms_before_mm", "RMS, found", "mm"}, [](J j) { return j.found.outside_rms_mm; }},
      {{"outside_rms_after_mm", "RMS, corrected", "mm"},
       [](J j) { return j.corrected.outside_rms_mm; }},
      {column_of(error::kMissed), [](J j) { return j.found.missed_percent; }},
      {column_of(error::kFalse), [](J j) { return j.found.false_percent; }}};
  return columns;
}

/// All that is known of each set of scans and rung.
Table judgements_table(const std::vector<Judgement>& judgements) {
  using J = Judgement;
  std::vector<Field<J>> fields = {{{"scans"}, &J::name},
                                  {{"held_out", "held out"}, &J::of},
                                  {{"rung"}, &J::rung},
                                  {{"pixels"}, &J::pixels}};
  fields.insert(fields.end(), judgement_columns().begin(), judgement_columns().end());
  return table_of<J>({.name = "held_out"}, judgements, fields);
}

std::string choice_text(const TermChoice& choice) {
  std::string text = "Terms taken by cross-validation over " + std::to_string(choice.folds) +
                     " folds of the training scans (each set, and each phantom with several sets, "
                     "held out in turn), with the mean square that is left, mean over folds:";
  for (const ChosenTerm& chosen : choice.order) {
    text.append(&chosen == &choice.order.front() ? " " : ", ");
    text.append(error_terms().at(chosen.term).name).append(" ");
    text.append(fixed(100 * chosen.left, 1)).append(" %");
  }
  return text + (choice.order.empty() ? " none; nothing is better than no correction." : ".");
}

std::string model_text(const ModelStudy& study) {
  return "Mean and spread of the error along the pixel's ray, found less true, from " +
         std::to_string(study.model.rows) + " pixels of " + std::to_string(study.training_scans) +
         " scans; intervals by bootstrap of " + std::to_string(study.model.blocks) +
         " blocks, one for all seeds at a place. Pixels more than " +
         fixed(kOtherSurface_m / kMillimetre, 0) + " mm off show another surface and are left out.";
}

void add_model(const ModelStudy& study, Document& document) {
  document.add(Heading{"Detection error"});
  document.add(Text{model_text(study)}).add(Text{choice_text(study.choice)});
  const Table terms = terms_table(study.model);
  document.add(terms);
  for (const auto& [one, other] : study.model.correlated) {
    document.add(Text{std::string("Correlated by more than 0.95: ") + term_name(one) + " and " +
                      term_name(other) + "."});
  }
  const Table judgements = judgements_table(all_judgements(study));
  document.add(with_columns(judgements,
                            {"scans",
                             "rung",
                             "pixels",
                             "mean_before_mm",
                             "mean_after_mm",
                             "rms_before_mm",
                             "rms_after_mm",
                             "explained_variance",
                             "reproducible_variance",
                             "explained_of_reproducible",
                             "within_one_spread_percent",
                             "within_two_spreads_percent"}));
  document.data.push_back({"fit_terms.csv", terms});
  document.data.push_back({"fit_held_out.csv", judgements});
  document.data.push_back({"fit_residuals.csv", residuals_table(study)});
  Table effects = with_columns(judgements_table(study.held_out),
                               {"scans",
                                "rung",
                                "median_before_mm",
                                "median_after_mm",
                                "p95_before_mm",
                                "p95_after_mm",
                                "outside_rms_before_mm",
                                "outside_rms_after_mm",
                                error::kMissed.key,
                                error::kFalse.key});
  effects.name = "effects";
  document.add(Heading{"Correction of held-out pictures"});
  document.add(
      Text{"Means over seeds; RMS outside the band at silhouettes; missed and false do not "
           "change."});
  document.add(std::move(effects));
}

/// Whether planted errors come back, and what the model explains of held-out errors.
KeyFigures answer_of(const FitResults& results) {
  KeyFigures figures;
  if (results.coverage) {
    int covered = 0;
    for (const PlantedParameter& planted : results.coverage->parameters) covered += planted.covered;
    const std::size_t all = results.coverage->parameters.size() * results.coverage->seeds.size();
    figures.all.push_back({"Planted errors of the probe",
                           std::to_string(covered) + " of " + std::to_string(all),
                           "",
                           "95 % intervals that hold what was planted"});
  }
  const Judgement& held_out = results.model.all_held_out;
  figures.all.push_back({"Detection error that is explained",
                         fixed(100 * held_out.removed_mean_square, 1),
                         "%",
                         "of the mean square on scans that the model was not fitted to: RMS " +
                             fixed(held_out.rms_before_mm, 2) + " mm found, " +
                             fixed(held_out.rms_after_mm, 2) + " mm corrected"});
  return figures;
}

}  // namespace

std::string fitted_text(const Registration& fit, int parameter) {
  const auto slot = static_cast<std::size_t>(parameter);
  const auto text = [&](double value) { return significant(in_unit(parameter, value), 3); };
  return std::string(kShown[parameter].name) + " " + text(fit.value.at(slot)) + " " +
         kShown[parameter].unit + " (" + text(fit.low.at(slot)) + " to " + text(fit.high.at(slot)) +
         ")";
}

Document fit_document(const FitResults& results, const Provenance& provenance) {
  Document document{.title = "Fit", .name = "fit"};
  document.add(answer_of(results));
  document.add(Text{"Made by `wobblebench fit`. Commit " + provenance.commit + ", " +
                    provenance.cpu + ", " + provenance.gl_renderer + "."});
  add_registration(results.known_pose, "Registration, the pose known", "known_pose", document);
  add_registration(results.nothing_known, "Registration, nothing known", "nothing_known", document);
  if (results.coverage) add_coverage(*results.coverage, document);
  add_model(results.model, document);
  for (const Figure& figure : fit_figures(results.model)) document.add(figure);
  for (const ResidualPicture& picture : results.model.pictures) {
    document.add(Picture{residuals_file(picture), residuals_caption(picture)});
  }
  return document;
}

namespace {

Json coverage_json(const Coverage& coverage) {
  return {{"seeds", coverage.seeds.size()},
          {"reference_seeds", coverage.reference.size()},
          {"repeatable_rms_mm", coverage.repeatable_rms_m / kMillimetre},
          {"random_rms_mm", coverage.random_rms_m / kMillimetre},
          {"parameters", to_json(coverage_table(coverage))}};
}

Json choice_json(const TermChoice& choice) {
  Json taken = Json::array();
  for (const ChosenTerm& chosen : choice.order) {
    taken.push_back({{"name", error_terms().at(chosen.term).name}, {"left", chosen.left}});
  }
  return {{"folds", choice.folds}, {"taken", taken}};
}

Json model_json(const ModelStudy& study) {
  Json correlated = Json::array();
  for (const auto& [one, other] : study.model.correlated) {
    correlated.push_back({term_name(one), term_name(other)});
  }
  return {{"choice", choice_json(study.choice)},
          {"terms", to_json(terms_table(study.model))},
          {"correlated", correlated},
          {"pixels", study.model.rows},
          {"blocks", study.model.blocks},
          {"training_scans", study.training_scans},
          {"explained_variance_held_out", number(study.all_held_out.explained_variance)},
          {"scans", to_json(judgements_table(all_judgements(study)))}};
}

}  // namespace

Json fit_json(const FitResults& results) {
  Json registration = registration_json(results.known_pose);
  registration["nothing_known"] = registration_json(results.nothing_known);
  registration["coverage"] = results.coverage ? coverage_json(*results.coverage) : Json(nullptr);
  return {{"registration", registration}, {"model", model_json(results.model)}};
}

}  // namespace wobblebench::bench
