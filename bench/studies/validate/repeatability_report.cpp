#include <sstream>

#include "bench/studies/validate/study_reports.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

std::string hexadecimal(std::uint32_t value) {
  std::ostringstream text;
  text << std::hex << value;
  return text.str();
}

}  // namespace

StudyReport repeatability_report(const RepeatabilityInputs& inputs) {
  StudyReport report;
  report.id = "repeatability";
  report.title = "A seed means one set of bytes";
  std::ostringstream table;
  table << "| rung | phantom | samples | CRC-32C | samples that another seed changes |\n"
           "| --- | --- | ---: | --- | ---: |\n";
  for (const RepeatabilityResult& found : measure_repeatability(inputs)) {
    const sim::Rung rung = found.rung;
    const bool moving = found.moving, is_small = rung == sim::Rung::reference;
    const std::string state = moving ? "moving" : "still";
    const std::string name = "repeatability." + sim::to_string(rung) + "." + state;
    report.checks.push_back({name,
                             Check::Kind::at_most,
                             static_cast<double>(found.differing),
                             0,
                             0,
                             "samples",
                             "bytes of 1, 2 and 4 threads and of a second run are the same",
                             found.samples,
                             "samples in each of " + std::to_string(found.runs) + " runs",
                             {inputs.seed}});
    // At least half of them: fluid may be below the range of values with any seed.
    const bool random = rung != sim::Rung::geometry;
    report.checks.push_back(
        {name + ".other_seed",
         random ? Check::Kind::at_least : Check::Kind::at_most,
         found.other_seed,
         random ? 0.5 : 0.0,
         0,
         "of the samples",
         random ? "another seed means other speckle and noise" : "nothing in this rung is random",
         found.samples,
         "samples",
         {inputs.seed, inputs.seed + 1}});
    table << "| " << sim::to_string(rung) << " | " << (is_small ? "block" : inputs.phantom) << ", "
          << state << " | " << found.samples << " | " << hexadecimal(found.crc32c) << " | "
          << 100 * found.other_seed << " % |\n";
    report.points.push_back({name,
                             "seed",
                             static_cast<double>(inputs.seed),
                             "share_changed_by_other_seed",
                             found.other_seed,
                             {}});
  }
  report.text =
      "A coarse scan of the phantom, and for `reference` a few sticks of a small block: made anew "
      "by 1, 2 and 4 threads, by 4 once more, and with another seed. Linear output with the "
      "default noise, so that nothing hides below the display. Moving: on a path, breathing, and "
      "with its head turning.\n\n" +
      table.str();
  return report;
}

}  // namespace wobblebench::bench
