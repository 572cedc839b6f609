#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "bench/output/picture/panels.h"
#include "bench/output/report.h"
#include "bench/studies/fit/fit_report.h"

namespace wobblebench::bench {

namespace {

std::string text(double value) {
  constexpr int kDigits = 9;
  return significant(value, kDigits);
}

/// Figures of a judgement, by their names in report.json and fit_held_out.csv.
constexpr std::pair<const char*, double Judgement::*> kFigures[] = {
    {"other_surface_percent", &Judgement::other_surface_percent},
    {"mean_before_mm", &Judgement::mean_before_mm},
    {"mean_after_mm", &Judgement::mean_after_mm},
    {"rms_before_mm", &Judgement::rms_before_mm},
    {"rms_after_mm", &Judgement::rms_after_mm},
    {"explained_variance", &Judgement::explained_variance},
    {"removed_mean_square", &Judgement::removed_mean_square},
    {"reproducible_variance", &Judgement::reproducible_variance},
    {"within_one_spread_percent", &Judgement::within_one_percent},
    {"within_two_spreads_percent", &Judgement::within_two_percent}};

template <std::size_t N>
void write_terms(const char* part,
                 const std::array<FittedTerm, N>& terms,
                 const std::array<TermDescription, N>& descriptions,
                 std::ostream& rows) {
  for (std::size_t i = 0; i < N; ++i) {
    rows << part << "," << descriptions[i].name << "," << descriptions[i].unit << ",";
    if (terms[i].fitted) {
      rows << text(terms[i].value) << "," << text(terms[i].low) << "," << text(terms[i].high);
    } else {
      rows << ",,";
    }
    rows << "\n";
  }
}

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
  return {{"median_mm", effect.median_mm},
          {"p95_mm", effect.p95_mm},
          {"outside_silhouettes_rms_mm", effect.outside_rms_mm},
          {"missed_percent", effect.missed_percent},
          {"false_percent", effect.false_percent}};
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
  for (const auto& [name, figure] : kFigures) json[name] = number(judged.*figure);
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

constexpr int kPanelWidth = 300;
/// Grey 0 and 1 of the maps; no error is 0.5.
constexpr double kShown_m = 5e-3;

Picture3 grey_error(const Image<float>& error_m) {
  Image<float> values(error_m.width, error_m.height, 0.0f);
  for (std::size_t i = 0; i < values.pixels.size(); ++i) {
    const double error = static_cast<double>(error_m.pixels[i]);
    if (!std::isfinite(error)) continue;
    values.pixels[i] = static_cast<float>(std::clamp(0.5 + 0.5 * error / kShown_m, 0.0, 1.0));
  }
  return grey(values);
}

Chart bins_chart(const ModelStudy& study, const std::string& quantity, const std::string& label) {
  Chart chart{"", {label}, {"mean error (mm)"}};
  Series before{"found", {}, {}, Stroke::solid, Mark::disc};
  Series after{"corrected", {}, {}, Stroke::solid, Mark::square};
  for (const ResidualBin& bin : study.bins) {
    if (bin.quantity != quantity) continue;
    before.add(bin.at, bin.before_mm);
    after.add(bin.at, bin.after_mm);
  }
  chart.series = {before, after};
  return chart;
}

}  // namespace

std::string terms_csv(const DetectionModel& model) {
  std::ostringstream rows;
  rows << "part,term,unit,value,low,high\n";
  write_terms("bias", model.bias, error_terms(), rows);
  write_terms("spread", model.spread, spread_term_descriptions(), rows);
  return rows.str();
}

std::string judgements_csv(const ModelStudy& study) {
  std::ostringstream rows;
  rows << "scans,held_out,rung,pixels";
  for (const auto& [name, figure] : kFigures) rows << "," << name;
  rows << ",median_before_mm,median_after_mm,p95_before_mm,p95_after_mm,"
          "outside_rms_before_mm,outside_rms_after_mm,missed_percent,false_percent\n";
  const auto add = [&](const Judgement& judged) {
    const PictureEffect &found = judged.found, &corrected = judged.corrected;
    rows << judged.name << "," << judged.of << "," << judged.rung << "," << judged.pixels;
    for (const auto& [name, figure] : kFigures) rows << "," << text(judged.*figure);
    for (const double value : {found.median_mm,
                               corrected.median_mm,
                               found.p95_mm,
                               corrected.p95_mm,
                               found.outside_rms_mm,
                               corrected.outside_rms_mm,
                               found.missed_percent,
                               found.false_percent}) {
      rows << "," << text(value);
    }
    rows << "\n";
  };
  add(study.training);
  for (const Judgement& judged : study.held_out) add(judged);
  add(study.all_held_out);
  return rows.str();
}

std::string residuals_csv(const ModelStudy& study) {
  std::ostringstream rows;
  rows << "quantity,at,pixels,mean_error_before_mm,mean_error_after_mm\n";
  for (const ResidualBin& bin : study.bins) {
    rows << bin.quantity << "," << text(bin.at) << "," << bin.pixels << "," << text(bin.before_mm)
         << "," << text(bin.after_mm) << "\n";
  }
  return rows.str();
}

std::string coverage_csv(const Coverage& coverage) {
  std::ostringstream rows;
  rows << "scan,seed,parameter,planted,value,low,high\n";
  const auto add = [&](const char* scan, const PlantedSeed& fitted, bool planted) {
    for (const PlantedParameter& row : coverage.parameters) {
      const auto slot = static_cast<std::size_t>(row.parameter);
      rows << scan << "," << fitted.seed << "," << registration_names()[slot] << ","
           << text(planted ? row.planted : 0) << "," << text(fitted.fit.value[slot]) << ","
           << text(fitted.fit.low[slot]) << "," << text(fitted.fit.high[slot]) << "\n";
    }
  };
  for (const PlantedSeed& fitted : coverage.reference) add("reference", fitted, false);
  for (const PlantedSeed& fitted : coverage.seeds) add("planted", fitted, true);
  return rows.str();
}

nlohmann::ordered_json fit_json(const FitResults& results) {
  Json registration = registration_json(results.known_pose);
  registration["nothing_known"] = registration_json(results.nothing_known);
  registration["coverage"] = results.coverage ? coverage_json(*results.coverage) : Json(nullptr);
  return {{"registration", registration}, {"model", model_json(results.model)}};
}

std::vector<Figure> fit_figures(const ModelStudy& study) {
  Figure figure{"residuals", "Mean error of all held-out pixels, found and corrected.", {}};
  for (const auto& [quantity, label] : {std::pair{"incidence_deg", "incidence (deg)"},
                                        {"range_mm", "range (mm)"},
                                        {"contrast", "contrast (of full scale)"}}) {
    Chart chart = bins_chart(study, quantity, label);
    if (!chart.series.front().x.empty()) figure.panels.emplace_back(std::move(chart));
  }
  if (figure.panels.empty()) return {};
  return {figure};
}

std::vector<NamedPicture> residual_pictures(const ModelStudy& study) {
  std::vector<NamedPicture> pictures;
  for (const ResidualPicture& picture : study.pictures) {
    const std::vector<Panel> panels = {{"error", grey_error(picture.error_m)},
                                       {"model's bias", grey_error(picture.bias_m)},
                                       {"left", grey_error(picture.left_m)}};
    pictures.push_back(
        {"fit_residuals_" + picture.name + ".png",
         "Held out (" + picture.name +
             "): error, the model's bias, what is left. Black is 5 mm too near or no surface, "
             "white 5 "
             "mm too far.",
         draw_panels(panels, kPanelWidth)});
  }
  return pictures;
}

}  // namespace wobblebench::bench
