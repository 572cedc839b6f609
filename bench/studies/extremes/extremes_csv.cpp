#include <algorithm>
#include <sstream>

#include "base/number_text.h"
#include "base/text.h"
#include "bench/studies/extremes/extremes_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kDigits = 4;

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

}  // namespace

int ExtremesResults::failed() const {
  const auto failed = [](const auto& outcome) { return !outcome.passed(); };
  return static_cast<int>(std::count_if(cases.begin(), cases.end(), failed) +
                          std::count_if(numbers.begin(), numbers.end(), failed));
}

std::string verdict(const ExtremeOutcome& outcome) {
  if (outcome.passed()) return outcome.rendered ? "rendered" : "refused";
  std::string text = "FAILED";
  for (const std::string& failure : outcome.failures) {
    text += (text == "FAILED" ? ": " : "; ") + failure;
  }
  return text;
}

std::string extremes_csv(const ExtremesResults& results) {
  std::ostringstream csv;
  csv << "case,preset,settings,verdict,refusal,finite,changed_out_of_reach,pass,worst,bound,"
         "compared,outside\n";
  for (const ExtremeOutcome& outcome : results.cases) {
    const auto& changed = outcome.changed_out_of_reach;
    std::ostringstream head;
    head << csv_field(outcome.of.name) << "," << outcome.preset << ","
         << csv_field(joined(outcome.of.settings)) << "," << csv_field(verdict(outcome)) << ","
         << csv_field(outcome.refusal) << ","
         << (outcome.rendered ? (outcome.finite ? "1" : "0") : "") << ","
         << (changed ? std::to_string(*changed) : "");
    if (outcome.errors.empty()) csv << head.str() << ",,,,,\n";
    for (const PassError& error : outcome.errors) {
      csv << head.str() << "," << csv_field(error.pass) << "," << significant(error.worst, kDigits)
          << "," << significant(error.bound, kDigits) << "," << error.compared << ","
          << error.outside << "\n";
    }
  }
  for (const NumberOutcome& number : results.numbers) {
    csv << csv_field(number.name) << ",,," << (number.passed() ? "passed" : "FAILED") << ",,,,"
        << csv_field(number.unit) << "," << significant(number.worst, kDigits) << ","
        << significant(number.bound, kDigits) << ",,\n";
  }
  return csv.str();
}

}  // namespace wobblebench::bench
