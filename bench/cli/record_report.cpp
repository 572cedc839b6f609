#include "bench/cli/record_report.h"

#include <nlohmann/json.hpp>
#include <sstream>

#include "base/units.h"
#include "bench/cli/board_report.h"
#include "bench/cli/simulation_report.h"
#include "bench/output/report.h"
#include "bench/pipeline/iq_file.h"

namespace wobblebench::bench {

namespace {

const char* to_string(hw::RecordingEnd end) {
  switch (end) {
    case hw::RecordingEnd::volumes:
      return "as many volumes as asked for";
    case hw::RecordingEnd::end_of_stream:
      return "the stream is over";
    case hw::RecordingEnd::lost:
      return "the device is lost";
    case hw::RecordingEnd::stop_requested:
      return "interrupted";
  }
  return "unknown";
}

/// What a reader of the array has to know.
Json iq_json(const hw::AcquisitionPlan& plan, std::uint64_t volumes) {
  const IqShape shape = iq_shape(plan, volumes);
  const double spacing_mm =
      plan.acquisition().depth_m / static_cast<double>(shape.back()) / kMillimetre;
  return {{"file", kIqName},
          {"type", "complex64"},
          {"axes", {"volume", "frame", "line", "sample"}},
          {"shape", shape},
          {"sample_spacing_mm", spacing_mm},
          {"first_sample_mm", spacing_mm / 2},
          {"center_frequency_mhz", plan.probe().center_frequency_hz / kMegahertz},
          {"phase", "demodulated at the centre frequency, with phase 0 at range 0"},
          {"scale", "1: a perfect mirror; with noise, before envelope detection and TGC"}};
}

}  // namespace

std::uint64_t volumes_begun(const hw::RecordingProgress& progress) {
  if (!progress.configuration) return 0;
  const auto sticks = static_cast<std::uint64_t>(progress.configuration->plan.sticks_per_volume());
  return (progress.next_sequence + sticks - 1) / sticks;
}

std::string record_report(const RecordResult& result, Scene scene) {
  const hw::RecordingProgress& progress = result.progress;
  const hw::Configuration& configuration = progress.configuration.value();
  scene.acquisition = configuration.plan.acquisition();
  static_cast<hw::ProbeOptions&>(scene.probe) = configuration.plan.probe();
  Provenance provenance = provenance_of_this_machine();
  provenance.board = hw::to_string(result.link.origin);
  Json report = report_head("record", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report_fidelity(report, result.fidelity);
  if (!result.fidelity) report_stream_scale(report, configuration.display_scale);
  report["board"] = account_json(progress.account);
  report["board"]["damage"] = {{"places", progress.damage.regions},
                               {"bytes_skipped", progress.damage.bytes_skipped}};
  report["board"]["link"] = link_json(result.link);
  report["recording"] = {{"file", kRecordingName},
                         {"bytes", progress.bytes},
                         {"volumes", progress.volumes},
                         {"display_scale", display_scale_json(configuration.display_scale)},
                         {"ended_because", to_string(result.end)}};
  report["iq"] =
      result.with_iq ? iq_json(configuration.plan, volumes_begun(progress)) : Json(nullptr);
  return report_text(report);
}

std::string record_summary(const RecordResult& result, const std::filesystem::path& folder) {
  const hw::RecordingProgress& progress = result.progress;
  std::ostringstream text;
  text << "recorded    " << progress.volumes << " volumes, " << progress.account.delivered
       << " sticks, " << static_cast<double>(progress.bytes) / 1e6 << " MB; "
       << progress.account.lost.total() << " sticks lost; " << to_string(result.end) << "\n";
  if (result.fidelity) {
    text << "simulator   " << sim::to_string(result.fidelity->rung) << ": "
         << result.fidelity->reason << "\n";
  }
  text << "recording   " << (folder / kRecordingName).string() << "\n";
  if (result.with_iq) text << "IQ samples  " << (folder / kIqName).string() << "\n";
  return text.str();
}

}  // namespace wobblebench::bench
