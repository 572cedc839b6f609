#include "bench/studies/tolerance/tolerance_question.h"

#include <algorithm>

#include "base/user_error.h"
#include "bench/studies/accuracy/accuracy_plan.h"
#include "bench/studies/tolerance/tolerance_ladder.h"

namespace wobblebench::bench {

namespace {

constexpr int kSeeds = 3;
constexpr int kRepeats = 2;
constexpr const char* kRungs[] = {"geometry", "field", "scatterers"};  // by cost

}  // namespace

ToleranceQuestion::ToleranceQuestion(const ToleranceRequest& request)
    : request_(request), given_(load({}).given), finest_(choose_finest_rung()) {
  for (const char* key : {"render.preset", "render.correction"}) {
    if (given_.contains(key)) {
      throw UserError(std::string("--tolerance: chooses the settings of the renderer; leave ") +
                      key + " out");
    }
  }
}

std::vector<std::string> ToleranceQuestion::coarser_rungs() const {
  if (given_.contains(kRungKey)) return {};
  return {std::begin(kRungs), std::ranges::find(kRungs, finest_)};
}

TradeWork ToleranceQuestion::work() const {
  std::vector<std::string> rungs = coarser_rungs();
  rungs.insert(rungs.begin(), finest_);
  TradeWork work{.plan = plan(), .points = {}, .more = {}};
  for (const std::string& rung : rungs) {
    for (const auto& values : tolerance_ladder().settings) {
      const TradePoint point = point_of(values, rung);
      if (std::ranges::find(work.points, point) == work.points.end()) work.points.push_back(point);
    }
  }
  return work;
}

Scene ToleranceQuestion::load(const std::vector<std::string>& more) const {
  std::vector<std::string> settings = request_.settings;
  settings.insert(settings.end(), more.begin(), more.end());
  return load_scene(request_.file, settings);
}

std::string ToleranceQuestion::choose_finest_rung() const {
  if (given_.contains(kRungKey)) return sim::to_string(load({}).simulation.fidelity);
  for (std::size_t i = std::size(kRungs); i-- > 1;) {
    try {
      load({std::string(kRungKey) + "=" + kRungs[i]});
      return kRungs[i];
    } catch (const UserError&) {  // a coarser one, then
    }
  }
  return kRungs[0];
}

std::vector<std::size_t> ToleranceQuestion::free_keys() const {
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < tolerance_ladder().keys.size(); ++i) {
    if (!given_.contains(tolerance_ladder().keys[i])) free.push_back(i);
  }
  return free;
}

TradePlan ToleranceQuestion::plan() const {
  TradePlan plan;
  plan.source = "--tolerance";
  plan.of_one_scene = true;
  plan.repeats = kRepeats;
  plan.seeds = seed_list(load({}).simulation.seed + 1, kSeeds);
  plan.scenes = {{"scene", request_.file, request_.settings}};
  for (const std::size_t i : free_keys()) {
    plan.axes.push_back({tolerance_ladder().keys[i], {}, {}});
  }
  if (!given_.contains(kRungKey)) plan.axes.push_back({kRungKey, {}, {}});
  return plan;
}

TradePoint ToleranceQuestion::point_of(const std::vector<std::string>& values,
                                       const std::string& rung) const {
  TradePoint point;
  for (const std::size_t i : free_keys()) point.values.push_back(values[i]);
  if (!given_.contains(kRungKey)) point.values.push_back(rung);
  return point;
}

}  // namespace wobblebench::bench
