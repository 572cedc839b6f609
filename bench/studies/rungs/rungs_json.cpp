#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/studies/rungs/rungs_report.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

const RungError* error_of(const RungsResults& results, sim::Rung rung) {
  for (const RungError& error : results.errors) {
    if (error.body == results.phantom && error.rung == rung) return &error;
  }
  return nullptr;
}

}  // namespace

Json rungs_json(const RungsResults& results) {
  Json points = Json::array(), front = Json::array();
  struct Point {
    std::string rung;
    double time;
    double error;
  };
  std::vector<Point> all;
  for (const RungTime& time : results.times) {
    const RungError* error = error_of(results, time.rung);
    if (error == nullptr) continue;
    all.push_back({sim::to_string(time.rung),
                   time.first_ms.median / results.sound_ms,
                   error->against_truth.p95_abs_mm});
  }
  for (const Point& point : all) {
    points.push_back({{"settings", {{"simulation.fidelity", point.rung}}},
                      {"time_ratio", point.time},
                      {"error_mm_p95", point.error}});
    const bool beaten = std::any_of(all.begin(), all.end(), [&](const Point& other) {
      return other.time <= point.time && other.error <= point.error &&
             (other.time < point.time || other.error < point.error);
    });
    if (!beaten) front.push_back(point.rung);
  }
  return {{"points", points}, {"front", front}};
}

std::string rungs_figure_file(const Figure& figure) {
  return "rungs_" + figure.name + ".png";
}

}  // namespace wobblebench::bench
