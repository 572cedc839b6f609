#include "bench/studies/compare/compare_document.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/number_text.h"
#include "bench/studies/compare/compared_side.h"

namespace wobblebench::bench {

namespace {

std::ptrdiff_t count(const ComparisonResult& result, Outcome outcome) {
  return std::ranges::count(result.verdicts, outcome, &Verdict::outcome);
}

/// What broke first.
std::vector<const Verdict*> by_outcome(const ComparisonResult& result) {
  std::vector<const Verdict*> sorted;
  for (const Verdict& verdict : result.verdicts) sorted.push_back(&verdict);
  std::ranges::stable_sort(sorted, {}, &Verdict::outcome);
  return sorted;
}

Cell change_cell(const Verdict& verdict) {
  if (verdict.change.n == 0) return {};
  const double scale = verdict.limit.allowed == Allowed::ratio ? 100 : 1;
  return Cell::interval(scale * verdict.change.mean, scale * verdict.change.half);
}

std::string outcome_text(const Verdict& verdict) {
  std::string text = to_string(verdict.outcome);
  return verdict.why.empty() ? text : text.append(": ").append(verdict.why);
}

/// What is counted shows all its digits.
Cell mean_cell(const MeanInterval& of, const ChangeLimit& limit) {
  if (kind_of_figure(limit.figure) != FigureKind::work || of.n == 0) return of.mean;
  return fixed(of.mean, of.mean == std::floor(of.mean) ? 0 : 1);
}

/// What broke, and how far off the next limits are.
KeyFigures verdict_figures(const ComparisonResult& result) {
  constexpr std::size_t kMost = 6;
  KeyFigures figures;
  for (const Verdict* const one : by_outcome(result)) {
    if (one->now.n == 0 || figures.all.size() == kMost) continue;
    const std::string& name = one->limit.figure;
    const Measure* const measure = run_measure(name);
    figures.add((measure == nullptr ? name : measure->title) + ", " + one->scene,
                one->now.mean,
                name,
                std::string(to_string(one->outcome)) + ": " + change_text(*one) +
                    " against the base; " + text_of(one->limit),
                one->outcome == Outcome::broken);
  }
  return figures;
}

Table verdict_table(const ComparisonResult& result) {
  using V = Verdict;
  const auto unit = [](const V& of) { return unit_of(of.limit.figure).name; };
  std::vector<V> sorted;
  for (const V* const one : by_outcome(result)) sorted.push_back(*one);
  return table_of<V>(
      {.name = "verdicts",
       .caption = "Limits of the change from the base to the new side, over pairs of equal "
                  "seeds, with 95 % intervals (Student's t)"},
      sorted,
      {{{"scene"}, &V::scene},
       {{"figure"}, [](const V& of) { return Cell::code(of.limit.figure); }},
       {{"unit"}, unit},
       {{"base", "base", "", 5, true}, [](const V& of) { return mean_cell(of.base, of.limit); }},
       {{"new", "new", "", 5, true}, [](const V& of) { return mean_cell(of.now, of.limit); }},
       {{"change", "change", "", 3, true}, change_cell},
       {{"change_unit", "of the change"},
        [&](const V& of) { return of.limit.allowed == Allowed::ratio ? "%" : unit(of); }},
       {{"limit"}, [](const V& of) { return text_of(of.limit); }},
       {{"pairs"}, [](const V& of) { return of.change.n; }},
       {{"outcome"}, outcome_text}});
}

Table run_table(const ComparisonResult& result) {
  Table table{
      .name = "runs",
      .caption = "Every figure of every run",
      .columns = {{"side"}, {"scene"}, {"seed"}, {"figure"}, {"value", "value", "", 9, true}}};
  for (const auto& [name, side] : {std::pair{"base", &result.base}, {"new", &result.now}}) {
    for (const MeasuredRun& run : side->runs) {
      for (const auto& [figure, value] : run.figures) {
        table.add({name, run.scene, std::to_string(run.seed), Cell::code(figure), value});
      }
    }
  }
  return table;
}

Table side_table(const ComparisonResult& result) {
  Table table{
      .name = "sides",
      .caption = "What was compared",
      .columns = {{"side"}, {"what"}, {"commit"}, {"cpu", "CPU"}, {"gl_renderer"}, {"runs"}}};
  for (const auto& [name, side] : {std::pair{"base", &result.base}, {"new", &result.now}}) {
    table.add({name,
               Cell::code(side->what + (side->kept ? " (kept)" : "")),
               side->commit,
               side->cpu,
               side->gl_renderer,
               side->runs.size()});
  }
  return table;
}

/// Settings of the scenes that the sides do not share.
Table setting_table(const ComparisonResult& result) {
  Table table{.name = "settings",
              .caption = "Settings that differ",
              .columns = {{"scene"}, {"setting"}, {"base"}, {"new"}}};
  const auto text_in = [](const auto& settings, const std::string& key) {
    const auto found = settings.find(key);
    return found == settings.end() ? Cell("has none") : Cell::code(found->second);
  };
  for (const auto& [scene, now] : result.now.settings) {
    const auto found = result.base.settings.find(scene);
    if (found == result.base.settings.end()) continue;
    std::set<std::string> keys;
    for (const auto* side : {&now, &found->second}) {
      for (const auto& [key, unused] : *side) keys.insert(key);
    }
    for (const std::string& key : keys) {
      const Cell before = text_in(found->second, key), after = text_in(now, key);
      if (before.text() != after.text()) table.add({scene, Cell::code(key), before, after});
    }
  }
  return table;
}

void add_pair(Document& page, const std::string& scene, const std::string& picture) {
  page.add(PicturePair{{compared_picture("base", scene, picture), "Base, " + scene + "."},
                       {compared_picture("new", scene, picture), "New, " + scene + "."}});
}

bool has(const std::vector<std::string>& scenes, const std::string& scene) {
  return std::ranges::find(scenes, scene) != scenes.end();
}

/// The scene of the first limit in the order of the figures that has pictures; empty: none has.
std::string leading_scene(const ComparisonResult& result) {
  for (const Verdict* const one : by_outcome(result)) {
    if (has(result.with_surface, one->scene)) return one->scene;
  }
  return "";
}

/// Without the surfaces of the scene that leads.
void add_pictures(const ComparisonResult& result, const std::string& leading, Document& page) {
  std::set<std::string> scenes(result.with_surface.begin(), result.with_surface.end());
  scenes.insert(result.with_error.begin(), result.with_error.end());
  for (const std::string& scene : scenes) {
    page.add(Heading{"Pictures of " + scene});
    if (has(result.with_surface, scene) && scene != leading) add_pair(page, scene, "surface");
    if (has(result.with_error, scene)) add_pair(page, scene, "error");
  }
}

}  // namespace

std::string verdict_line(const ComparisonResult& result) {
  if (result.base.runs.empty()) {
    return std::to_string(result.now.runs.size()) + " runs are kept, to compare others with";
  }
  std::string line = std::to_string(count(result, Outcome::broken)) + " of " +
                     std::to_string(result.verdicts.size()) + " limits " +
                     to_string(Outcome::broken);
  for (const Outcome outcome : {Outcome::open, Outcome::kept, Outcome::not_compared}) {
    const auto number = count(result, outcome);
    if (number > 0) line += ", " + std::to_string(number) + " " + to_string(outcome);
    if (number > 0 && outcome == Outcome::open) line += " (more seeds would tell)";
  }
  return line + (result.measured_twice ? "; measured twice, as a limit of time was broken" : "");
}

std::string verdict_lines(const ComparisonResult& result) {
  std::string lines;
  for (const Verdict* const one : by_outcome(result)) {
    if (one->outcome != Outcome::broken && one->outcome != Outcome::open) continue;
    lines.append("- **").append(to_string(one->outcome)).append("** ");
    lines.append(line_of(*one)).append("\n");
  }
  return lines;
}

std::vector<Check> test_cases(const ComparisonResult& result) {
  std::vector<Check> cases;
  for (const Verdict& verdict : result.verdicts) {
    const bool is_ratio = verdict.limit.allowed == Allowed::ratio;
    Check test{.group = verdict.scene,
               .name = verdict.limit.figure + " " + text_of(verdict.limit),
               .limit = verdict.limit.most};
    if (verdict.change.n > 0) test.value = verdict.change.mean + (is_ratio ? 1 : 0);
    if (verdict.outcome == Outcome::open) test.skipped = "open: more seeds would tell";
    if (verdict.outcome == Outcome::broken) test.failure = line_of(verdict);
    if (verdict.outcome == Outcome::not_compared) test.skipped = verdict.why;
    if (verdict.change.n > 0) test.output = line_of(verdict);
    cases.push_back(std::move(test));
  }
  return cases;
}

Document compare_document(const ComparisonResult& result) {
  Document page{
      .title = "wobblebench compare",
      .name = "compare",
      .data = {{"compare.csv", verdict_table(result)}, {"compare_runs.csv", run_table(result)}}};
  const bool compares = !result.base.runs.empty();
  page.add(
      Text{"**" + verdict_line(result) + "**" +
           (compares ? ". Base: `" + result.base.what + "`; new: `" + result.now.what + "`" : "")});
  if (compares) page.add(verdict_figures(result));
  const std::string leading = leading_scene(result);
  if (!leading.empty()) add_pair(page, leading, "surface");
  if (!result.verdicts.empty()) page.add(verdict_table(result));
  page.add(side_table(result));
  const Table settings = setting_table(result);
  if (!compares) return page;
  if (settings.rows.empty()) {
    page.add(Text{"Both sides have the same settings of the scenes."});
  } else {
    page.add(settings);
  }
  add_pictures(result, leading, page);
  return page;
}

}  // namespace wobblebench::bench
