// What becomes of the ends of every range, of bad samples, and of numbers at their ends.
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/number_text.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/output/report.h"
#include "bench/output/report_parts.h"
#include "bench/studies/extremes/extremes.h"

namespace wobblebench::bench {

namespace {

struct ExtremesResults {
  std::vector<ExtremeOutcome> cases;
  std::vector<NumberOutcome> numbers;

  int failed() const {
    const auto failed = [](const auto& outcome) { return !outcome.passed(); };
    return static_cast<int>(std::count_if(cases.begin(), cases.end(), failed) +
                            std::count_if(numbers.begin(), numbers.end(), failed));
  }
};

/// "rendered", "refused" or "FAILED: why".
std::string verdict(const ExtremeOutcome& outcome) {
  if (outcome.passed()) return outcome.rendered ? "rendered" : "refused";
  std::string text = "FAILED";
  for (const std::string& failure : outcome.failures) {
    text += (text == "FAILED" ? ": " : "; ") + failure;
  }
  return text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// "inf" and "nan" as texts.
Cell number_cell(double value) {
  return std::isfinite(value) ? Cell(value) : Cell(significant(value, 1));
}

/// One row a case, preset and pass; a refusal has one row without a pass.
Table all_rows(const std::vector<ExtremeOutcome>& cases) {
  using R = std::pair<const ExtremeOutcome*, const PassError*>;
  std::vector<R> rows;
  for (const ExtremeOutcome& outcome : cases) {
    if (outcome.errors.empty()) rows.emplace_back(&outcome, nullptr);
    for (const PassError& error : outcome.errors) rows.emplace_back(&outcome, &error);
  }
  const auto of_pass = [](const auto& value) {
    return [value](const R& row) { return row.second ? Cell(value(*row.second)) : Cell(); };
  };
  using E = PassError;
  return table_of<R>(
      {.name = "rows"},
      rows,
      {{{"case"}, [](const R& of) { return of.first->of.name; }},
       {{"preset"}, [](const R& of) { return of.first->preset; }},
       {{"settings"}, [](const R& of) { return joined(of.first->of.settings); }},
       {{"verdict"}, [](const R& of) { return verdict(*of.first); }},
       {{"refusal"}, [](const R& of) { return of.first->refusal; }},
       {{"finite"},
        [](const R& of) { return of.first->rendered ? Cell(of.first->finite ? 1 : 0) : Cell(); }},
       {{"changed_out_of_reach"},
        [](const R& of) {
          const auto& changed = of.first->changed_out_of_reach;
          return changed ? Cell(*changed) : Cell();
        }},
       {{"pass"}, of_pass([](const E& of) { return of.pass; })},
       {{"worst"}, of_pass([](const E& of) { return number_cell(of.worst); })},
       {{"bound"}, of_pass([](const E& of) { return number_cell(of.bound); })},
       {{"compared"}, of_pass([](const E& of) { return of.compared; })},
       {{"outside"}, of_pass([](const E& of) { return of.outside; })}});
}

KeyFigures answer_of(const ExtremesResults& results) {
  const auto refused =
      std::ranges::count_if(results.cases, [](const ExtremeOutcome& of) { return !of.rendered; });
  const std::size_t all = results.cases.size() + results.numbers.size();
  const std::string held = std::to_string(refused) +
                           " refused by one line, the others within bounds of double precision";
  return {{{"Failed",
            std::to_string(results.failed()) + " of " + std::to_string(all),
            "outcomes",
            results.failed() == 0 ? held : "those that are marked FAILED below",
            results.failed() > 0}}};
}

std::string origin_of(const Provenance& provenance) {
  return "Made by `wobblebench extremes`. Commit " + provenance.commit + ", " + provenance.cpu +
         ", GL: " + provenance.gl_backend + ", " + provenance.gl_renderer +
         ". Settings, bounds and the number of pixels are in `extremes.csv`.";
}

constexpr char kMethod[] =
    "Sticks, where a case does not name simulated ones, are of a soft-edged ball in noise, in "
    "closed form. Each cell is the greatest difference of a pass from the same pass in double "
    "precision on the same input, and behind the slash the greatest that the bounds of its pixels "
    "allow; of slices and colours in full scales, of z relative to the ray's length. Bounds follow "
    "from the arithmetic, not from measurement (decision 32); inf: no bound, as the motor's axis "
    "lies among the samples, and only finite numbers are asked for.";

/// "1.2e-05 / 3e-05".
std::string cell(const PassError& error) {
  const auto text = [](double value) { return std::isinf(value) ? "inf" : significant(value, 2); };
  return text(error.worst) + " / " + text(error.bound) +
         (error.outside > 0 ? " (" + std::to_string(error.outside) + " beyond)" : "");
}

/// A column for each pass.
Table rendered_table(const std::vector<ExtremeOutcome>& cases) {
  Table table{.name = "rendered", .columns = {{"case"}, {"preset"}, {"outcome"}}};
  const std::size_t before = table.columns.size();
  for (const ExtremeOutcome& outcome : cases) {
    if (outcome.errors.size() <= table.columns.size() - before) continue;
    table.columns.resize(before);
    for (const PassError& error : outcome.errors) table.columns.push_back({error.pass});
  }
  for (const ExtremeOutcome& outcome : cases) {
    if (!outcome.rendered) continue;
    std::vector<Cell> row = {
        outcome.of.name, outcome.preset, verdict(outcome) + (outcome.passed() ? ", finite" : "")};
    for (const PassError& error : outcome.errors) row.emplace_back(cell(error));
    row.resize(table.columns.size());
    table.add(std::move(row));
  }
  return table;
}

Table refused_table(const std::vector<ExtremeOutcome>& cases) {
  Table table{.name = "refused", .columns = {{"case"}, {"preset"}, {"outcome"}, {"line"}}};
  for (const ExtremeOutcome& outcome : cases) {
    if (outcome.rendered) continue;
    table.add({outcome.of.name, outcome.preset, verdict(outcome), outcome.refusal});
  }
  return table;
}

Table reach_table(const std::vector<ExtremeOutcome>& cases) {
  Table table{.name = "reach", .columns = {{"case"}, {"preset"}, {"pixels"}}};
  for (const ExtremeOutcome& outcome : cases) {
    if (!outcome.changed_out_of_reach) continue;
    table.add({outcome.of.name, outcome.preset, *outcome.changed_out_of_reach});
  }
  return table;
}

Table numbers_table(const std::vector<NumberOutcome>& numbers) {
  using N = NumberOutcome;
  return table_of<N>(
      {.name = "numbers"},
      numbers,
      {{{"name", "case"}, &N::name},
       {{"passed"}, &N::passed},
       {{"worst", "error", "", 2, true}, [](const N& of) { return number_cell(of.worst); }},
       {{"bound", "bound", "", 2, true}, [](const N& of) { return number_cell(of.bound); }},
       {{"unit"}, &N::unit},
       {{"how", "against"}, &N::how}});
}

Document extremes_document(const ExtremesResults& results, const Provenance& provenance) {
  Document document{.title = "The extremes", .name = "extremes"};
  document.add(answer_of(results)).add(Text{origin_of(provenance)}).add(Text{kMethod});
  document.add(Heading{"Rendered"}).add(rendered_table(results.cases));
  document.add(Heading{"Refused"}).add(refused_table(results.cases));
  document.add(Heading{"One bad sample"})
      .add(Text{"Pixels whose z changed out of the reach of the sample: their rays read no other "
                "sample in double precision."})
      .add(reach_table(results.cases));
  document.add(Heading{"Numbers"}).add(numbers_table(results.numbers));
  document.data = {{"extremes.csv", all_rows(results.cases)},
                   {"extremes_numbers.csv", numbers_table(results.numbers)}};
  return document;
}

Json errors_json(const std::vector<PassError>& errors) {
  using E = PassError;
  return to_json(table_of<E>({},
                             errors,
                             {{{"pass"}, &E::pass},
                              {{"worst"}, &E::worst},
                              {{"bound"}, &E::bound},
                              {{"compared"}, &E::compared},
                              {{"outside"}, &E::outside}}));
}

/// "extremes".
Json extremes_json(const ExtremesResults& results) {
  Json cases = Json::array();
  for (const ExtremeOutcome& outcome : results.cases) {
    Json json = {{"name", outcome.of.name},
                 {"preset", outcome.preset},
                 {"settings", outcome.of.settings},
                 {"passed", outcome.passed()},
                 {"failures", outcome.failures},
                 {"rendered", outcome.rendered}};
    if (!outcome.rendered) json["refusal"] = outcome.refusal;
    if (outcome.rendered) json["finite"] = outcome.finite;
    if (outcome.changed_out_of_reach) json["changed_out_of_reach"] = *outcome.changed_out_of_reach;
    json["passes"] = errors_json(outcome.errors);
    cases.push_back(std::move(json));
  }
  return {{"failed", results.failed()},
          {"cases", cases},
          {"numbers", to_json(numbers_table(results.numbers))}};
}

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
    for (const auto preset : {render::RenderPreset::baseline, render::RenderPreset::accurate}) {
      outcomes.push_back(run_extreme_case(of, preset, context, cache));
      // What is refused is refused before any preset matters.
      if (of.must == MustHappen::refuse && outcomes.back().passed()) break;
    }
    parts.finish_one();
  }
  return outcomes;
}

std::string failures_text(const ExtremesResults& results) {
  std::string text;
  for (const ExtremeOutcome& outcome : results.cases) {
    if (outcome.passed()) continue;
    text += outcome.of.name + ", " + outcome.preset + ": " + verdict(outcome) + "\n";
  }
  for (const NumberOutcome& number : results.numbers) {
    if (!number.passed()) text += number.name + ": FAILED\n";
  }
  return text + std::to_string(results.cases.size() + results.numbers.size()) + " outcomes, " +
         std::to_string(results.failed()) + " failed\n";
}

CommandResult measure_and_write(const Arguments& arguments,
                                render::GlContext& context,
                                Progress& progress) {
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  ExtremesResults results;
  results.cases = progress.step("cases", [&](const PartDone& done) {
    return run_cases(cases_of(arguments), context, cache, done);
  });
  results.numbers = run_number_cases();
  const Provenance provenance = provenance_of_simulation(context, arguments.seed);
  Json report = report_head("extremes", provenance, load_scene({}, base_settings(), "extremes"));
  report["extremes"] = extremes_json(results);
  report["wall_ms"] = wall_json(progress.times());
  return {.report = report_text(report),
          .summary = failures_text(results),
          .exit_code = results.failed() == 0 ? kDone : kFailed,
          .checks = {none_failed("outcomes", results.failed())},
          .document = extremes_document(results, provenance)};
}

int run_extremes(const Arguments& arguments) {
  const auto context = render::make_context(arguments.gl);
  return run_in_folder(arguments.output, {{"cases", 1}}, [&](OutputFolder&, Progress& progress) {
    warn_of_software(*context, arguments.gl, progress);
    return measure_and_write(arguments, *context, progress);
  });
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
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return run_extremes(*arguments); }};
}

}  // namespace wobblebench::bench
