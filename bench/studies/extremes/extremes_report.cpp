#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/number_text.h"
#include "bench/studies/extremes/extremes_report.h"

namespace wobblebench::bench {

namespace {

void write_head(const ExtremesResults& results,
                const Provenance& provenance,
                std::ostream& markdown) {
  markdown
      << "# The extremes\n\nMade by `wobblebench extremes`. Commit " << provenance.commit << ", "
      << provenance.cpu << ", GL: " << provenance.gl_backend << ", " << provenance.gl_renderer
      << ". " << results.cases.size() + results.numbers.size() << " outcomes, " << results.failed()
      << " failed. Settings, bounds and the number of pixels are in `extremes.csv`.\n\n"
         "Sticks, where a case does not name simulated ones, are of a soft-edged ball in noise, in "
         "closed form. Each cell is the greatest difference of a pass from the same pass in "
         "double precision on the same input, and behind the slash the greatest that the bounds of "
         "its "
         "pixels allow; of slices and colours in full scales, of z relative to the ray's length. "
         "Bounds follow from the arithmetic, not from measurement:\n\n"
         "- u = 2^-24 is the unit roundoff of float32; a result of k rounded operations is within "
         "k u of its greatest intermediate value. Fixed-point texels round by half a level each "
         "time that they are stored: frame, rows, slice.\n"
         "- An error of place (position, texture coordinate, motor angle from table or arc "
         "tangent) counts by the greatest difference between neighbouring samples or pixels.\n"
         "- A detector decides, so no error of z is bounded by itself: z must lie between those "
         "that the reference finds with the threshold moved by the bound of what the detector "
         "compares (n samples, each rounded to 2^-18), and with the picture moved by the bound of "
         "a "
         "position.\n"
         "- A normal is as wrong as its two differences of positions, over their product; a "
         "shadow's border may lie where the light's turn by a position's error in a pixel puts "
         "it.\n"
         "- inf: no bound; the motor's axis lies among the samples, where a frame's number has no "
         "bounded slope. Only finite numbers are asked for there.\n";
}

/// "1.2e-05 / 3e-05".
std::string cell(const PassError& error) {
  const auto text = [](double value) { return std::isinf(value) ? "inf" : significant(value, 2); };
  return text(error.worst) + " / " + text(error.bound) +
         (error.outside > 0 ? " (" + std::to_string(error.outside) + " beyond)" : "");
}

void write_rendered(const ExtremesResults& results, std::ostream& markdown) {
  const auto& cases = results.cases;
  const auto first = std::find_if(
      cases.begin(), cases.end(), [](const auto& outcome) { return !outcome.errors.empty(); });
  if (first == cases.end()) return;
  markdown << "\n## Rendered\n\n| case | preset | outcome |";
  for (const PassError& error : first->errors) markdown << " " << error.pass << " |";
  markdown << "\n| --- | --- | --- |";
  for (std::size_t i = 0; i < first->errors.size(); ++i) markdown << " --- |";
  markdown << "\n";
  for (const ExtremeOutcome& outcome : cases) {
    if (!outcome.rendered) continue;
    markdown << "| " << outcome.of.name << " | " << outcome.preset << " | " << verdict(outcome)
             << (outcome.passed() ? ", finite" : "") << " |";
    for (const PassError& error : outcome.errors) markdown << " " << cell(error) << " |";
    for (std::size_t i = outcome.errors.size(); i < first->errors.size(); ++i) markdown << " |";
    markdown << "\n";
  }
}

void write_refused(const ExtremesResults& results, std::ostream& markdown) {
  markdown << "\n## Refused\n\n| case | preset | outcome | line |\n| --- | --- | --- | --- |\n";
  for (const ExtremeOutcome& outcome : results.cases) {
    if (outcome.rendered) continue;
    markdown << "| " << outcome.of.name << " | " << outcome.preset << " | " << verdict(outcome)
             << " | " << outcome.refusal << " |\n";
  }
}

void write_reach(const ExtremesResults& results, std::ostream& markdown) {
  markdown << "\n## One bad sample\n\nPixels whose z changed out of the reach of the sample, which "
              "is taken in closed form.\n\n| case | preset | pixels |\n| --- | --- | ---: |\n";
  for (const ExtremeOutcome& outcome : results.cases) {
    if (!outcome.changed_out_of_reach) continue;
    markdown << "| " << outcome.of.name << " | " << outcome.preset << " | "
             << *outcome.changed_out_of_reach << " |\n";
  }
}

void write_numbers(const ExtremesResults& results, std::ostream& markdown) {
  markdown << "\n## Numbers\n\n| case | outcome | error | bound | unit | against |\n| --- | --- | "
              "---: | ---: | --- | --- |\n";
  for (const NumberOutcome& number : results.numbers) {
    markdown << "| " << number.name << " | " << (number.passed() ? "passed" : "FAILED") << " | "
             << significant(number.worst, 2) << " | " << significant(number.bound, 2) << " | "
             << number.unit << " | " << number.how << " |\n";
  }
}

}  // namespace

std::string extremes_markdown(const ExtremesResults& results, const Provenance& provenance) {
  std::ostringstream markdown;
  write_head(results, provenance, markdown);
  write_rendered(results, markdown);
  write_refused(results, markdown);
  write_reach(results, markdown);
  write_numbers(results, markdown);
  return markdown.str();
}

}  // namespace wobblebench::bench
