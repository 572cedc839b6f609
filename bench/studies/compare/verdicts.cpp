#include "bench/studies/compare/verdicts.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

struct Pairs {
  bool any = false;  ///< runs of one scene and seed
  std::vector<double> base, now;
  bool base_alone = false,
       now_alone = false;  ///< the figure of a seed was formed on one side alone
};

const double* find(const MeasuredRun& run, const std::string& figure) {
  const auto found = run.figures.find(figure);
  return found == run.figures.end() ? nullptr : &found->second;
}

/// Runs of one scene with the same seed, in their order: a seed may have been measured twice.
Pairs pairs_of(const MeasuredSide& base,
               const MeasuredSide& now,
               const std::string& scene,
               const std::string& figure) {
  Pairs pairs;
  std::set<const MeasuredRun*> used;
  for (const MeasuredRun& run : now.runs) {
    if (run.scene != scene) continue;
    const auto partner = std::ranges::find_if(base.runs, [&](const MeasuredRun& other) {
      return other.scene == scene && other.seed == run.seed && !used.contains(&other);
    });
    if (partner == base.runs.end()) continue;
    used.insert(&*partner);
    pairs.any = true;
    const double *before = find(*partner, figure), *after = find(run, figure);
    if (before != nullptr && after != nullptr) {
      pairs.base.push_back(*before);
      pairs.now.push_back(*after);
    } else {
      pairs.base_alone |= before != nullptr;
      pairs.now_alone |= after != nullptr;
    }
  }
  return pairs;
}

/// Without an interval where there is one pair, or no pair differs from another.
MeanInterval change_of(const Pairs& pairs, Allowed allowed) {
  if (allowed != Allowed::ratio) return paired_difference(pairs.now, pairs.base);
  std::vector<double> logs;
  for (std::size_t i = 0; i < pairs.now.size(); ++i) {
    logs.push_back(std::log(pairs.now[i] / pairs.base[i]));
  }
  const MeanInterval log = mean_interval(logs);
  const double ratio = std::exp(log.mean);
  // The interval of a ratio is wider above than below it; the wider side is taken for both.
  return {ratio - 1, ratio * std::expm1(log.half), log.n};
}

Outcome outcome_of(const MeanInterval& change, const ChangeLimit& limit) {
  const bool noisy = kind_of_figure(limit.figure) == FigureKind::time;
  if (noisy && !std::isfinite(change.half)) return Outcome::open;
  const double half = std::isfinite(change.half) ? change.half : 0;
  const bool both_ways = limit.allowed == Allowed::changed_by;
  const double worse = worse_of(limit.figure) == Worse::lower ? -change.mean : change.mean;
  const double size = both_ways ? std::abs(change.mean) : worse;
  const double most = limit.allowed == Allowed::ratio ? limit.most - 1 : limit.most;
  if (size - half > most) return Outcome::broken;
  return size + half <= most ? Outcome::kept : Outcome::open;
}

/// Of what is counted, which has no noise, and of what must be equal: each pair keeps the limit.
Outcome exact_outcome(const Pairs& pairs, const ChangeLimit& limit) {
  bool kept = pairs.now == pairs.base;
  if (limit.allowed == Allowed::ratio) {
    kept = std::ranges::equal(
        pairs.now, pairs.base, [&](double now, double base) { return now <= limit.most * base; });
  }
  return kept ? Outcome::kept : Outcome::broken;
}

/// Why a figure of these sides cannot be compared; empty: it can.
std::string why_not(const MeasuredSide& base, const MeasuredSide& now, const ChangeLimit& limit) {
  const FigureKind kind = kind_of_figure(limit.figure);
  if (kind == FigureKind::time && (base.kept || now.kept)) {
    return "times of kept figures are of another hour";
  }
  if (kind == FigureKind::work && base.gl_renderer != now.gl_renderer) {
    return "counted by another renderer: " + base.gl_renderer;
  }
  return "";
}

Verdict verdict_of(const MeasuredSide& base,
                   const MeasuredSide& now,
                   const std::string& scene,
                   const ChangeLimit& limit) {
  Verdict verdict{.scene = scene, .limit = limit};
  const Pairs pairs = pairs_of(base, now, scene, limit.figure);
  verdict.base = mean_interval(pairs.base);
  verdict.now = mean_interval(pairs.now);
  verdict.why = why_not(base, now, limit);
  if (!verdict.why.empty()) return verdict;
  if (!pairs.any) {
    verdict.why = "the base has no run of this scene with the same seed";
  } else if (pairs.now_alone && pairs.base_alone) {
    verdict.why = "formed on different seeds";
  } else if (pairs.now_alone) {
    verdict.why = "the base does not have it";
  } else if (pairs.base_alone) {
    verdict.outcome = Outcome::broken;
    verdict.why = "was formed by the base, and no more";
  } else if (pairs.base.empty()) {
    verdict.why = "formed by neither side";
  }
  if (!verdict.why.empty()) return verdict;
  verdict.change = change_of(pairs, limit.allowed);
  const bool counted = kind_of_figure(limit.figure) == FigureKind::work;
  const bool exact =
      limit.allowed == Allowed::equal || (counted && limit.allowed == Allowed::ratio);
  verdict.outcome = exact ? exact_outcome(pairs, limit) : outcome_of(verdict.change, limit);
  return verdict;
}

std::string signed_text(double value) {
  return std::string(value > 0 ? "+" : "").append(significant(value, 4));
}

}  // namespace

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kept:
      return "kept";
    case Outcome::broken:
      return "BROKEN";
    case Outcome::open:
      return "open";
    case Outcome::not_compared:
      break;
  }
  return "not compared";
}

std::vector<Verdict> verdicts(const MeasuredSide& base,
                              const MeasuredSide& now,
                              const std::vector<ChangeLimit>& limits) {
  std::vector<std::string> scenes;
  for (const MeasuredRun& run : now.runs) {
    if (std::ranges::find(scenes, run.scene) == scenes.end()) scenes.push_back(run.scene);
  }
  std::vector<Verdict> all;
  for (const std::string& scene : scenes) {
    for (const ChangeLimit& limit : limits) all.push_back(verdict_of(base, now, scene, limit));
  }
  return all;
}

bool only_times_are_broken(const std::vector<Verdict>& all) {
  bool any = false;
  for (const Verdict& verdict : all) {
    if (verdict.outcome != Outcome::broken) continue;
    if (kind_of_figure(verdict.limit.figure) != FigureKind::time) return false;
    any = true;
  }
  return any;
}

std::string change_text(const Verdict& verdict) {
  const bool ratio = verdict.limit.allowed == Allowed::ratio;
  const double scale = ratio ? 100 : 1;
  std::string text = signed_text(scale * verdict.change.mean) + (ratio ? " %" : "");
  if (!std::isfinite(verdict.change.half)) return text;
  return text + " (" + signed_text(scale * (verdict.change.mean - verdict.change.half)) + " to " +
         signed_text(scale * (verdict.change.mean + verdict.change.half)) + ")";
}

std::string line_of(const Verdict& verdict) {
  const std::string unit = unit_of(verdict.limit.figure).name;
  std::string line = verdict.scene + ": " + verdict.limit.figure;
  if (verdict.change.n == 0) return line + ": " + verdict.why;
  // So that one fetch among millions shows.
  const int digits = kind_of_figure(verdict.limit.figure) == FigureKind::work ? 9 : 4;
  return line + " " + significant(verdict.base.mean, digits) + " to " +
         significant(verdict.now.mean, digits) + (unit.empty() ? "" : " ") + unit + ": " +
         change_text(verdict) + "; " + text_of(verdict.limit);
}

}  // namespace wobblebench::bench
