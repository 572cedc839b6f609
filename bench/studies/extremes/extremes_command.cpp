// What becomes of the ends of every range, of bad samples, and of numbers at their ends.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/output/report.h"
#include "bench/studies/extremes/extremes_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kRandomCases = 20, kLongRandomCases = 200;

struct Arguments {
  CacheArguments cache;
  OutputArguments output;
  std::uint64_t seed = 1;
  bool is_long = false;
  std::string gl = "auto";
};

std::vector<ExtremeCase> cases_of(const Arguments& arguments) {
  std::vector<ExtremeCase> cases = extreme_cases();
  const auto append = [&](const std::vector<ExtremeCase>& more) {
    cases.insert(cases.end(), more.begin(), more.end());
  };
  if (arguments.is_long) append(long_extreme_cases());
  append(random_extreme_cases(arguments.seed, arguments.is_long ? kLongRandomCases : kRandomCases));
  return cases;
}

std::vector<ExtremeOutcome> run_cases(const std::vector<ExtremeCase>& cases,
                                      render::GlContext& context,
                                      PhantomCache& cache,
                                      const PartDone& done) {
  std::vector<ExtremeOutcome> outcomes;
  PartCount parts(cases.size(), done);
  for (const ExtremeCase& of : cases) {
    for (const auto preset : {render::RenderPreset::paper, render::RenderPreset::accurate}) {
      outcomes.push_back(run_extreme_case(of, preset, context, cache));
      // What is refused is refused before any preset matters.
      if (of.must == MustHappen::refuse && outcomes.back().passed()) break;
    }
    parts.finish_one();
  }
  return outcomes;
}

void print_failures(const ExtremesResults& results) {
  for (const ExtremeOutcome& outcome : results.cases) {
    if (outcome.passed()) continue;
    std::cout << outcome.of.name << ", " << outcome.preset << ": " << verdict(outcome) << "\n";
  }
  for (const NumberOutcome& number : results.numbers) {
    if (!number.passed()) std::cout << number.name << ": FAILED\n";
  }
  std::cout << results.cases.size() + results.numbers.size() << " outcomes, " << results.failed()
            << " failed\n";
}

int run_extremes(const Arguments& arguments) {
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.output.folder);
  Progress progress({{"cases", 1}});
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  ExtremesResults results;
  results.cases = progress.step("cases", [&](const PartDone& done) {
    return run_cases(cases_of(arguments), *context, cache, done);
  });
  results.numbers = run_number_cases();
  const Provenance provenance = provenance_of_simulation(*context, arguments.seed);
  Json report = report_head("extremes", provenance, load_scene({}, base_settings(), "extremes"));
  report["extremes"] = extremes_json(results);
  report["wall_ms"] = wall_json(progress.times());
  const std::string text = report_text(report);
  out.write_text("extremes.md", extremes_markdown(results, provenance));
  out.write_text("extremes.csv", extremes_csv(results));
  out.write_text("report.json", text);
  out.commit();
  if (arguments.output.json) {
    std::cout << text;
  } else {
    print_failures(results);
  }
  return results.failed() == 0 ? 0 : 1;
}

}  // namespace

Command add_extremes_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(app,
                                     "extremes",
                                     "The ends of every range, bad samples and numbers at their "
                                     "ends: refused, or within bounds of double precision");
  add_flag(command,
           "--long",
           arguments->is_long,
           "Large pictures, a million steps and 200 random settings, too");
  add_seed(command, "--seed", arguments->seed, "Of the random settings");
  add_cache_options(command, arguments->cache);
  add_output_options(command, arguments->output);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return run_extremes(*arguments); }};
}

}  // namespace wobblebench::bench
