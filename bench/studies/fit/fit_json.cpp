#include <nlohmann/json.hpp>

#include "bench/output/report.h"
#include "bench/results/error.h"
#include "bench/studies/fit/fit_report.h"

namespace wobblebench::bench {

namespace {

Json coverage_json(const Coverage& coverage) {
  Json rows = Json::array();
  for (const PlantedParameter& row : coverage.parameters) {
    rows.push_back({{"name", registration_names().at(static_cast<std::size_t>(row.parameter))},
                    {"planted", row.planted},
                    {"mean_recovered", number(row.mean)},
                    {"standard_deviation", number(row.deviation)},
                    {"mean_half_width", number(row.half_width)},
                    {"covered", row.covered},
                    {"held_nothing", row.held_nothing}});
  }
  return {{"seeds", coverage.seeds.size()},
          {"reference_seeds", coverage.reference.size()},
          {"repeatable_rms_mm", coverage.repeatable_rms_m / kMillimetre},
          {"random_rms_mm", coverage.random_rms_m / kMillimetre},
          {"parameters", rows}};
}

template <std::size_t N>
Json terms_json(const std::array<FittedTerm, N>& terms,
                const std::array<TermDescription, N>& descriptions) {
  Json list = Json::array();
  for (std::size_t i = 0; i < N; ++i) {
    const bool fitted = terms[i].fitted;
    list.push_back({{"name", descriptions[i].name},
                    {"unit", descriptions[i].unit},
                    {"meaning", descriptions[i].meaning},
                    {"value", fitted ? Json(terms[i].value) : Json(nullptr)},
                    {"low", fitted ? Json(terms[i].low) : Json(nullptr)},
                    {"high", fitted ? Json(terms[i].high) : Json(nullptr)}});
  }
  return list;
}

Json effect_json(const PictureEffect& effect) {
  return {{error::kMedian.key, number(effect.median_mm)},
          {error::kP95.key, number(effect.p95_mm)},
          {"outside_silhouettes_rms_mm", number(effect.outside_rms_mm)},
          {error::kMissed.key, number(effect.missed_percent)},
          {error::kFalse.key, number(effect.false_percent)}};
}

Json choice_json(const TermChoice& choice) {
  Json taken = Json::array();
  for (const ChosenTerm& chosen : choice.order) {
    taken.push_back({{"name", error_terms().at(chosen.term).name}, {"left", chosen.left}});
  }
  return {{"folds", choice.folds}, {"taken", taken}};
}

Json judgement_json(const Judgement& judged) {
  Json json = {{"name", judged.name},
               {"held_out", judged.of},
               {"rung", judged.rung},
               {"pixels", judged.pixels}};
  for (std::size_t i = 0; i < kReportedFigures; ++i) {
    const Field<Judgement>& of = judgement_columns()[i];
    json[of.column.key] = number(of.cell(judged).number());
  }
  json["found"] = effect_json(judged.found);
  json["corrected"] = effect_json(judged.corrected);
  return json;
}

Json model_json(const ModelStudy& study) {
  Json correlated = Json::array(), held_out = Json::array();
  for (const auto& [one, other] : study.model.correlated) {
    correlated.push_back({error_terms().at(static_cast<std::size_t>(one)).name,
                          error_terms().at(static_cast<std::size_t>(other)).name});
  }
  for (const Judgement& judged : study.held_out) held_out.push_back(judgement_json(judged));
  return {{"choice", choice_json(study.choice)},
          {"terms", terms_json(study.model.bias, error_terms())},
          {"spread_terms", terms_json(study.model.spread, spread_term_descriptions())},
          {"correlated", correlated},
          {"pixels", study.model.rows},
          {"blocks", study.model.blocks},
          {"training_scans", study.training_scans},
          {"explained_variance_held_out", number(study.all_held_out.explained_variance)},
          {"training", judgement_json(study.training)},
          {"held_out", held_out},
          {"all_held_out", judgement_json(study.all_held_out)}};
}

}  // namespace

nlohmann::ordered_json fit_json(const FitResults& results) {
  Json registration = registration_json(results.known_pose);
  registration["nothing_known"] = registration_json(results.nothing_known);
  registration["coverage"] = results.coverage ? coverage_json(*results.coverage) : Json(nullptr);
  return {{"registration", registration}, {"model", model_json(results.model)}};
}

}  // namespace wobblebench::bench
