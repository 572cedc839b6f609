#include "bench/cli/board_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/number_text.h"
#include "bench/output/report_parts.h"
#include "bench/results/counts.h"

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

}  // namespace

std::string summary_list(const std::string& summary) {
  constexpr std::size_t kNameColumns = 12;
  std::string list;
  std::istringstream lines(summary);
  for (std::string line; std::getline(lines, line);) {
    const std::string text = trimmed(line.size() > kNameColumns ? line.substr(kNameColumns) : "");
    const std::string name = trimmed(line.substr(0, kNameColumns));
    if (name == "results") continue;  // where this page is
    if (name.empty()) {
      list += "; " + text;
    } else {
      list += (list.empty() ? "- **" : "\n- **") + name + "** " + text;
    }
  }
  return list + "\n";
}

std::string losses_text(const hw::BoardAccount& account) {
  std::string text;
  for (const MeasuredValue& one : described(account)) {
    const bool is_loss = one.name.starts_with("lost") && one.value > 0;
    if (is_loss) text += ", " + fixed(one.value, 0) + " " + one.measure->title;
  }
  return text;
}

Table board_table(const hw::BoardAccount& account) {
  const double all = static_cast<double>(account.emitted);
  using M = MeasuredValue;
  return table_of<M>({.name = "board", .caption = "Sticks by what became of them"},
                     described(account),
                     {{{"what"}, [](const M& of) { return of.measure->title; }},
                      {{"sticks"}, [](const M& of) { return std::llround(of.value); }},
                      {{"percent", "of those emitted", "%", 3},
                       [&](const M& of) { return 100 * of.value / all; }}});
}

Json account_json(const hw::BoardAccount& account) {
  return to_json(described(account));
}

Json link_json(const hw::LinkCapabilities& link) {
  return {{"provenance", hw::to_string(link.origin)},
          {"copy_in", link.copy_in},
          {"waits_for_reader", link.waits_for_reader},
          {"buffer_bytes", link.buffer_bytes},
          {"buffers", link.buffers},
          {"buffers_per_interrupt", link.buffers_per_interrupt}};
}

Json display_scale_json(const hw::DisplayScale& scale) {
  if (!scale.knows_range()) return nullptr;
  const auto stated = [&](double value) { return scale.stated() ? Json(value) : Json(nullptr); };
  return {{"full_scale_db", stated(scale.full_scale_db)},
          {"dynamic_range_db", scale.dynamic_range_db},
          {"tgc_db_per_cm_mhz", stated(scale.tgc_db_per_cm_mhz)}};
}

std::string display_scale_text(const hw::DisplayScale& scale) {
  if (scale.range_alone) {
    return "dynamic range " + significant(scale.dynamic_range_db, 6) + " dB; the rest is unknown";
  }
  if (!scale.stated()) return "unknown: the samples do not say";
  return "full scale " + significant(scale.full_scale_db, 6) + " dB, dynamic range " +
         significant(scale.dynamic_range_db, 6) + " dB, TGC " +
         significant(scale.tgc_db_per_cm_mhz, 6) + " dB/cm/MHz";
}

void report_stream_scale(Json& report, const hw::DisplayScale& scale) {
  const Json stated = display_scale_json(scale);
  for (const char* key : {"full_scale_db", "dynamic_range_db", "tgc_db_per_cm_mhz"}) {
    report["scene"]["simulation"][key] = stated.is_null() ? Json(nullptr) : stated[key];
  }
}

Json samples_json(const ReceivedSamples& samples) {
  const bool linear = samples.scale == hw::SampleScale::linear_envelope;
  const auto range = samples.dynamic_range_db;
  return {{"scale", linear ? "linear" : "log"},
          {"count", samples.count},
          {"least", samples.least},
          {"most", samples.most},
          {"out_of_range", samples.out_of_range},
          {"log_compressed_over_db", range ? Json(*range) : Json(nullptr)}};
}

Json board_json(const Acquisition& acquisition) {
  Json json = account_json(acquisition.account);
  json.erase("duplicates");  // of all that was read
  json["arguments"] = acquisition.board;
  json["samples_from"] = hw::to_string(acquisition.source);
  json["samples"] = samples_json(acquisition.samples);
  json["display_scale"] = display_scale_json(acquisition.display_scale);
  json["volume"] = acquisition.volume.volume_index();
  json["missing_sticks"] = acquisition.volume.missing_sticks();
  json["ending"] = acquisition.ending.empty() ? Json(nullptr) : Json(acquisition.ending);
  json["link"] = link_json(acquisition.link);
  return json;
}

Json board_timing_json(const Acquisition& acquisition) {
  Json json = account_json(acquisition.read);
  json["damage"] = {{"places", acquisition.damage.regions},
                    {"bytes_skipped", acquisition.damage.bytes_skipped}};
  json["transport_ms"] = acquisition.transport_ms;
  return json;
}

void report_fidelity(Json& report, const std::optional<sim::Fidelity>& fidelity) {
  Json ran = Json::array(), left_out = Json::array();
  report["simulation"] = nullptr;
  if (fidelity) {
    for (const sim::Effect& effect : fidelity->effects) {
      if (effect.left_out.empty()) {
        ran.push_back(effect.name);
      } else {
        left_out.push_back({{"effect", effect.name}, {"why", effect.left_out}});
      }
    }
    report["simulation"] = {{"rung", sim::to_string(fidelity->rung)},
                            {"reason", fidelity->reason},
                            {"left_out", left_out}};
  }
  report["effects"] = ran;
}

void report_simulation(Json& report,
                       const std::optional<SimulatedVolume>& simulated,
                       const hw::AcquisitionPlan& plan,
                       std::uint64_t volumes) {
  report_fidelity(report, simulated ? std::optional(simulated->fidelity) : std::nullopt);
  if (!simulated) return;
  const double volume_ms =
      simulated->volume_ms / static_cast<double>(std::max<std::uint64_t>(volumes, 1));
  const double sound_ms = to_milliseconds(plan.volume_duration());
  report["simulation"].update({{"map_ms", simulated->map_ms},
                               {"once_ms", simulated->once_ms},
                               {"ms_per_volume", volume_ms},
                               {"times_real_time", number(sound_ms / volume_ms)},
                               {"late_ms", simulated->late_ms},
                               {"packets_dropped", simulated->packets_dropped}});
}

}  // namespace wobblebench::bench
