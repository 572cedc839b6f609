#include "bench/pipeline/stream/stream_summary.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

namespace wobblebench::bench {

namespace {

using OfPicture = std::function<double(const PictureTimes&)>;

std::vector<double> values_of(const StreamResult& result, const OfPicture& value) {
  std::vector<double> values;
  for (const PictureTimes& times : result.records) values.push_back(value(times));
  return values;
}

bool is_scheduled(const StreamResult& result) {
  return !result.records.empty() &&
         std::ranges::all_of(result.records, [](const PictureTimes& times) {
           return times.first.fired && times.last.fired;
         });
}

hw::HostTime start_of(const StickTimes& stick, bool scheduled) {
  return scheduled ? *stick.fired : stick.acquired;
}

std::vector<double> intervals_of(const StreamResult& result) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < result.records.size(); ++i) {
    intervals.push_back(to_milliseconds(result.records[i].ready - result.records[i - 1].ready));
  }
  return intervals;
}

double deviation_of(const std::vector<double>& values) {
  if (values.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0, squares = 0;
  for (const double value : values) sum += value;
  const double mean = sum / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

void summarize_rates(const StreamResult& result, StreamSummary& summary) {
  const auto intervals = intervals_of(result);
  summary.interval = percentiles_of(intervals);
  summary.jitter_ms = deviation_of(intervals);
  if (intervals.empty()) return;
  summary.seconds =
      1e-3 * to_milliseconds(result.records.back().ready - result.records.front().ready);
  const auto whole = static_cast<double>(
      std::ranges::count_if(result.records, [](const auto& times) { return times.whole; }));
  summary.pictures_per_s = static_cast<double>(intervals.size()) / summary.seconds;
  summary.volumes_per_s =
      summary.pictures_per_s * whole / static_cast<double>(result.records.size());
}

/// Each busy time over the volumes that its stage worked on.
std::vector<StageLoad> loads_of(const StreamResult& result, double sound_ms, double simulator_ms) {
  const auto per = [](double ms, std::uint64_t volumes) {
    return volumes == 0 ? 0 : ms / static_cast<double>(volumes);
  };
  const std::uint64_t rendered = result.shown.volumes + result.superseded_pictures.volumes;
  std::vector<StageLoad> loads = {{"board", per(result.reader.busy_ms, result.reader.volumes)},
                                  {"renderer", per(result.renderer_busy_ms, rendered)},
                                  {"sink", per(result.sink_busy_ms, result.shown.volumes)}};
  if (sound_ms > 0) loads.push_back({"sound", sound_ms});
  if (simulator_ms > 0) loads.push_back({"simulator", simulator_ms});
  std::ranges::sort(loads, std::greater{}, &StageLoad::ms_per_volume);
  return loads;
}

}  // namespace

StreamSummary summarize(const StreamResult& result,
                        double sound_ms,
                        double simulator_ms,
                        const std::optional<CardDelays>& card) {
  StreamSummary summary;
  const bool scheduled = summary.scheduled = is_scheduled(result);
  const auto of = [&](const OfPicture& value) { return percentiles_of(values_of(result, value)); };
  summary.age_oldest = of([scheduled](const PictureTimes& times) {
    return to_milliseconds(times.ready - start_of(times.first, scheduled));
  });
  summary.age_newest = of([scheduled](const PictureTimes& times) {
    return to_milliseconds(times.ready - start_of(times.last, scheduled));
  });
  summary.spans = latency_spans(result, card);
  summary.ready_to_written =
      of([](const PictureTimes& times) { return to_milliseconds(times.written - times.ready); });
  summarize_rates(result, summary);
  summary.loads = loads_of(result, sound_ms, simulator_ms);
  return summary;
}

Bottleneck bottleneck_of(const StreamSummary& summary) {
  const StageLoad& first = summary.loads.at(0);
  return {first.stage, first.ms_per_volume / summary.loads.at(1).ms_per_volume};
}

}  // namespace wobblebench::bench
