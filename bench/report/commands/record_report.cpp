#include "bench/report/commands/record_report.h"

#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/report/commands/board_report.h"
#include "bench/report/report.h"

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

}  // namespace

std::string record_report(const hw::RecordingProgress& progress,
                          hw::RecordingEnd end,
                          const hw::LinkCapabilities& link,
                          Scene scene) {
  if (progress.configuration) {
    scene.acquisition = progress.configuration->plan.acquisition();
    static_cast<hw::ProbeOptions&>(scene.probe) = progress.configuration->plan.probe();
  }
  Provenance provenance = provenance_of_this_machine();
  provenance.board = hw::to_string(link.origin);
  Json report = report_head("record", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["board"] = account_json(progress.account);
  report["board"]["damage"] = {{"places", progress.damage.regions},
                               {"bytes_skipped", progress.damage.bytes_skipped}};
  report["board"]["link"] = link_json(link);
  report["recording"] = {{"file", kRecordingName},
                         {"bytes", progress.bytes},
                         {"volumes", progress.volumes},
                         {"ended_because", to_string(end)}};
  return report_text(report);
}

std::string record_summary(const hw::RecordingProgress& progress,
                           hw::RecordingEnd end,
                           const std::filesystem::path& path) {
  std::ostringstream text;
  text << "recorded    " << progress.volumes << " volumes, " << progress.account.delivered
       << " sticks, " << static_cast<double>(progress.bytes) / 1e6 << " MB; "
       << progress.account.lost.total() << " sticks lost; " << to_string(end) << "\n"
       << "recording   " << path.string() << "\n";
  return text.str();
}

}  // namespace wobblebench::bench
