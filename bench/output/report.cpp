#include "bench/output/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace wobblebench::bench {

Json scene_json(const Scene& scene) {
  Json json = resolved(scene);
  const auto drop = [&](const std::string& key) {
    if (scene.framed || scene.given.contains(key)) return;
    std::string place = "/" + key;
    std::ranges::replace(place, '.', '/');
    json[Json::json_pointer(place)] = nullptr;
  };
  drop("placement.position_mm");
  drop("render.volume_of_interest.center_mm");
  drop("render.volume_of_interest.size_mm");
  drop("render.reconstruction.display_range_db");
  return json;
}

Json report_head(const std::string& command, Provenance provenance, const Scene& scene) {
  provenance.seed = scene.simulation.seed;
  return {{"schema", kReportSchema},
          {"command", command},
          {"provenance", to_json(provenance)},
          {"scene", scene_json(scene)},
          {"effects", Json::array()}};
}

double frame_ms(const std::vector<render::PassTime>& passes) {
  double sum = 0;
  for (const auto& pass : passes) sum += pass.ms;
  return sum;
}

Json render_json(const std::vector<render::PassTime>& passes, render::PipelineMode mode) {
  Json list = Json::array();
  for (const auto& pass : passes) {
    list.push_back({{"name", pass.name},
                    {"ms", pass.ms},
                    {"gpu_ms", pass.gpu_ms < 0 ? Json(nullptr) : Json(pass.gpu_ms)}});
  }
  return {{"mode", render::to_string(mode)}, {"passes", list}, {"frame_ms", frame_ms(passes)}};
}

Json registration_json(const Registration& registration) {
  const auto& names = registration_names();
  Json parameters = Json::array();
  for (int i = 0; i < kRegistrationParameters; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    parameters.push_back({{"name", names[slot]},
                          {"value", number(registration.value[slot])},
                          {"low", number(registration.low[slot])},
                          {"high", number(registration.high[slot])},
                          {"standard_deviation", number(registration.standard_deviation(i))}});
  }
  Json covariance = Json::array(), correlation = Json::array();
  for (double value : registration.covariance) covariance.push_back(number(value));
  for (int i = 0; i < kRegistrationParameters; ++i) {
    for (int j = 0; j < kRegistrationParameters; ++j) {
      correlation.push_back(number(registration.correlation(i, j)));
    }
  }
  Json unseen = Json::array(), correlated = Json::array();
  for (const auto& [combination, ratio] : registration.unseen) {
    Json list = Json::array();
    for (const int parameter : combination)
      list.push_back(names.at(static_cast<std::size_t>(parameter)));
    unseen.push_back({{"parameters", list}, {"data_over_prior", number(ratio)}});
  }
  for (const auto& [one, other] : registration.correlated) {
    correlated.push_back(
        {names.at(static_cast<std::size_t>(one)), names.at(static_cast<std::size_t>(other))});
  }
  return {{"converged", registration.converged},
          {"within_priors", registration.within_priors},
          {"points", registration.points},
          {"points_sampled", registration.sampled},
          {"blocks", registration.blocks},
          {"block_mm", kErrorBlock_m / kMillimetre},
          {"variance_inflation", number(registration.variance_inflation)},
          {"parameters", parameters},
          {"not_told_apart", unseen},
          {"correlated", correlated},
          {"covariance", covariance},
          {"correlation", correlation},
          {"rms_before_mm", number(registration.rms_before_m / kMillimetre)},
          {"rms_after_mm", number(registration.rms_after_m / kMillimetre)}};
}

Json measures_json(const phantoms::Phantom& phantom) {
  if (phantom.measures().empty()) return nullptr;
  Json measures = Json::object();
  for (const auto& measure : phantom.measures()) {
    measures[measure.name] = {{"measured", number(measure.value)},
                              {"drawn", measure.target ? number(*measure.target) : Json(nullptr)}};
  }
  return measures;
}

}  // namespace wobblebench::bench
