#include "bench/studies/tolerance/tolerance_report.h"

#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "bench/output/report_parts.h"
#include "bench/studies/tune/tune_study.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

Json setting_json(const ToleranceSetting& setting) {
  const TradeScore& score = setting.score;
  return {{"settings", setting.text},
          {"holds", setting.holds},
          {kToleranceMeasure, number(quantity_of(score, kToleranceMeasure).value)},
          {"outside_p95_bound_mm", number(upper_quantity(score, kToleranceMeasure).value)},
          {kWrongMeasure, number(quantity_of(score, kWrongMeasure).value)},
          {"missed_or_false_bound_percent", number(upper_quantity(score, kWrongMeasure).value)},
          {"volume_ms", number(score.volume_ms)}};
}

Json rungs_json(const ToleranceChoice& choice) {
  Json rungs = Json::array();
  for (const ToleranceRung& rung : choice.rungs) {
    rungs.push_back({{"rung", rung.name},
                     {"difference_mm", number(rung.difference_mm.mean)},
                     {"half_interval_mm", number(rung.difference_mm.half)},
                     {"agrees", rung.agrees}});
  }
  return rungs;
}

std::string in_mm(double value_mm) {
  return significant(value_mm, 3) + " mm";
}

}  // namespace

Json tolerance_json(const ToleranceResult& result) {
  const ToleranceChoice& choice = result.choice;
  Json measured = Json::array();
  for (const ToleranceSetting& setting : choice.settings) measured.push_back(setting_json(setting));
  return {{"tolerance_mm", choice.request.tolerance_mm},
          {"of", kToleranceMeasure},
          {"most_missed_or_false_percent", kMostWrongPercent},
          {"promised", choice.promised},
          {"reached_mm", number(result.outcome.reached_mm)},
          {"reached_missed_or_false_percent", number(result.outcome.wrong_percent)},
          {"held", result.outcome.held},
          {"chosen", choice.scene_settings},
          {"predicted_render_ms", number(choice.setting().score.volume_ms)},
          {"render_ms", number(result.render_ms)},
          {"rung", choice.rung},
          {"finest_rung", choice.finest_rung},
          {"rungs", rungs_json(choice)},
          {"measured", measured},
          {"seeds", choice.seeds},
          {"kept", choice.kept}};
}

std::string tolerance_lines(const ToleranceResult& result) {
  const ToleranceChoice& choice = result.choice;
  const ToleranceSetting& setting = choice.setting();
  std::string lines = "tolerance   " + in_mm(choice.request.tolerance_mm) +
                      ", P95 of depth more than 3 mm from a silhouette: ";
  lines += choice.promised ? "promised" : "cannot be promised";
  lines += " (a further seed: at most " +
           in_mm(upper_quantity(setting.score, kToleranceMeasure).value) + "), reached " +
           in_mm(result.outcome.reached_mm) +
           (result.outcome.held ? ", held there" : ", not held") + "\nchosen      " + setting.text +
           "; rung " + choice.rung + "; rendering predicted to take " +
           significant(setting.score.volume_ms, 3) + " ms, took " +
           significant(result.render_ms, 3) + " ms\n";
  return lines;
}

Check tolerance_check(const ToleranceResult& result) {
  const ToleranceChoice& choice = result.choice;
  const TradeScore& score = choice.setting().score;
  Check check{.group = "run",
              .name = "tolerance",
              .asked = "--tolerance = " + significant(choice.request.tolerance_mm, 6) + "mm",
              .limit = choice.request.tolerance_mm,
              .value = result.outcome.reached_mm};
  if (!choice.promised) {
    check.failure = "no setting keeps it on this scene; the least bound is " +
                    in_mm(upper_quantity(score, kToleranceMeasure).value) + ", with " +
                    significant(upper_quantity(score, kWrongMeasure).value, 3) +
                    " % missed or false (at most " + significant(kMostWrongPercent, 3) +
                    " % are allowed)";
  } else if (!result.outcome.held) {
    check.failure = "this picture reached " + in_mm(result.outcome.reached_mm) + " with " +
                    significant(result.outcome.wrong_percent, 3) + " % missed or false";
  }
  return check;
}

}  // namespace wobblebench::bench
