#include <sstream>

#include "base/number_text.h"
#include "bench/studies/fit/fit_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kDigits = 9;

std::string text(double value) {
  return significant(value, kDigits);
}

void add_term(std::ostream& rows,
              const char* part,
              const FittedTerm& term,
              const TermDescription& description) {
  rows << part << "," << description.name << "," << description.unit << ",";
  if (term.fitted)
    rows << text(term.value) << "," << text(term.low) << "," << text(term.high);
  else
    rows << ",,";
  rows << "\n";
}

}  // namespace

std::string terms_csv(const DetectionModel& model) {
  std::ostringstream rows;
  rows << "part,term,unit,value,low,high\n";
  for (std::size_t i = 0; i < kErrorTerms; ++i) {
    add_term(rows, "bias", model.bias[i], error_terms()[i]);
  }
  for (std::size_t i = 0; i < kSpreadTerms; ++i) {
    add_term(rows, "spread", model.spread[i], spread_term_descriptions()[i]);
  }
  return rows.str();
}

std::string judgements_csv(const ModelStudy& study) {
  std::ostringstream rows;
  rows << "scans,held_out,rung,pixels,other_surface_percent,mean_before_mm,mean_after_mm,rms_"
          "before_mm,"
          "rms_after_mm,explained_variance,removed_mean_square,reproducible_variance,within_one_"
          "spread_percent,"
          "within_two_spreads_percent,median_before_mm,median_after_mm,p95_before_mm,p95_after_mm,"
          "outside_rms_before_mm,outside_rms_after_mm,missed_percent,false_percent\n";
  const auto pair = [&](double before, double after) { return text(before) + "," + text(after); };
  const auto add = [&](const Judgement& judged) {
    rows << judged.name << "," << judged.of << "," << judged.rung << "," << judged.pixels << ","
         << text(judged.other_surface_percent) << "," << text(judged.mean_before_mm) << ","
         << text(judged.mean_after_mm) << "," << text(judged.rms_before_mm) << ","
         << text(judged.rms_after_mm) << "," << text(judged.explained_variance) << ","
         << text(judged.removed_mean_square) << "," << text(judged.reproducible_variance) << ","
         << text(judged.within_one_percent) << "," << text(judged.within_two_percent) << ","
         << pair(judged.found.median_mm, judged.corrected.median_mm) << ","
         << pair(judged.found.p95_mm, judged.corrected.p95_mm) << ","
         << pair(judged.found.outside_rms_mm, judged.corrected.outside_rms_mm) << ","
         << pair(judged.found.missed_percent, judged.found.false_percent) << "\n";
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

}  // namespace wobblebench::bench
