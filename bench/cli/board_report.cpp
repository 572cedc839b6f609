#include "bench/cli/board_report.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/number_text.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

namespace {

using LossCount = std::pair<std::string, std::uint64_t>;

/// Every cause, with its name in reports.
std::array<LossCount, 4> losses_by_cause(const hw::BoardAccount& account) {
  return {{{"ring_full", account.lost.ring_full},
           {"link", account.lost.link},
           {"corrupt", account.lost.corrupt},
           {"out_of_order", account.lost.out_of_order}}};
}

}  // namespace

std::string losses_text(const hw::BoardAccount& account) {
  std::string text;
  for (const auto& [cause, count] : losses_by_cause(account)) {
    if (count != 0) text += ", " + std::to_string(count) + " lost: " + cause;
  }
  return text;
}

Table board_table(const hw::BoardAccount& account) {
  Table table{.name = "board",
              .caption = "Sticks by what became of them",
              .columns = {{"what"}, {"sticks"}, {"percent", "of those emitted", "%", 3}}};
  const auto add = [&](const std::string& what, std::uint64_t count) {
    const double all = static_cast<double>(account.emitted);
    table.add({what, count, 100 * static_cast<double>(count) / all});
  };
  add("emitted", account.emitted);
  add("delivered", account.delivered);
  for (const auto& [cause, count] : losses_by_cause(account)) add("lost: " + cause, count);
  add("duplicates", account.duplicates);
  return table;
}

Json account_json(const hw::BoardAccount& account) {
  Json lost;
  for (const auto& [cause, count] : losses_by_cause(account)) lost[cause] = count;
  return {{"emitted", account.emitted},
          {"delivered", account.delivered},
          {"lost", lost},
          {"duplicates", account.duplicates}};
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
  if (!scale.stated()) return nullptr;
  return {{"full_scale_db", scale.full_scale_db},
          {"dynamic_range_db", scale.dynamic_range_db},
          {"tgc_db_per_cm_mhz", scale.tgc_db_per_cm_mhz}};
}

std::string display_scale_text(const hw::DisplayScale& scale) {
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
