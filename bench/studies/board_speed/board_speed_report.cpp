#include "bench/studies/board_speed/board_speed_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

/// Payload of one lane of PCIe 3.0 (reference 18).
constexpr double kLane_mb_s = 900;

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

}  // namespace

std::string board_speed_report(const Throughput& throughput,
                               const std::vector<CancelTimes>& cancels,
                               Provenance provenance) {
  provenance.board = "recording";
  provenance.seed = 1;
  Json stages = Json::array(), waits = Json::array();
  for (const StageSpeed& stage : throughput.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"median_mb_s", stage.mb_s.median},
                      {"min_mb_s", stage.mb_s.min},
                      {"max_mb_s", stage.mb_s.max}});
  }
  for (const CancelTimes& times : cancels) {
    waits.push_back({{"cancels", times.cancels},
                     {"load_threads", times.load_threads},
                     {"p50_ms", times.p50_ms},
                     {"p99_ms", times.p99_ms},
                     {"p999_ms", times.p999_ms},
                     {"max_ms", times.max_ms}});
  }
  const Json report = {{"schema", kReportSchema},
                       {"command", "board"},
                       {"provenance", to_json(provenance)},
                       {"throughput",
                        {{"bytes", throughput.bytes},
                         {"sticks", throughput.sticks},
                         {"repeats", throughput.repeats},
                         {"stages", stages}}},
                       {"cancel", waits}};
  return report_text(report);
}

std::string board_speed_markdown(const Throughput& throughput,
                                 const std::vector<CancelTimes>& cancels,
                                 const Provenance& provenance) {
  std::ostringstream text;
  text << "# What the board costs\n\nWritten by `wobblebench board`. CPU: " << provenance.cpu
       << ", " << provenance.threads << " threads. Commit: " << provenance.commit
       << ". Sticks of noise, seed 1; simulated, no card.\n\n## Throughput\n\nA recording of "
       << throughput.sticks << " sticks of the paper ("
       << rounded(double(throughput.bytes) / 1e6, 0)
       << " MB, in the page cache), all threads on one core; median of " << throughput.repeats
       << " runs, and range. The paper's stream is " << rounded(throughput.stream_mb_s, 1)
       << " MB/s; one lane of PCIe 3.0 carries about " << rounded(kLane_mb_s, 0)
       << " MB/s of payload.\n\n| stage | MB/s | range | ns a stick | times the paper's stream |\n"
          "| --- | ---: | ---: | ---: | ---: |\n";
  const double stick_bytes = double(throughput.bytes) / double(throughput.sticks);
  for (const StageSpeed& stage : throughput.stages) {
    text << "| " << stage.stage << " | " << rounded(stage.mb_s.median, 0) << " | "
         << rounded(stage.mb_s.min, 0) << " to " << rounded(stage.mb_s.max, 0) << " | "
         << rounded(stick_bytes / stage.mb_s.median * 1e3, 0) << " | "
         << rounded(stage.mb_s.median / throughput.stream_mb_s, 0) << " |\n";
  }
  text << "\n## Cancelling\n\nFrom the call of `cancel()` until the thread that waits in `next()` "
          "has "
          "returned, while a card sends in real time; the load are threads that do nothing but "
          "count.\n\n| cancels | load threads | P50 ms | P99 ms | P99.9 ms | max ms |\n"
          "| ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const CancelTimes& times : cancels) {
    text << "| " << times.cancels << " | " << times.load_threads << " | "
         << rounded(times.p50_ms, 3) << " | " << rounded(times.p99_ms, 3) << " | "
         << rounded(times.p999_ms, 3) << " | " << rounded(times.max_ms, 3) << " |\n";
  }
  return text.str();
}

}  // namespace wobblebench::bench
