#include "bench/pipeline/stream/stream_summary.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>

#include "base/statistics.h"

namespace wobblebench::bench {

Percentiles percentiles_of(const std::vector<double>& values_ms) {
  return {quantile(values_ms, 0.5),
          quantile(values_ms, 0.9),
          quantile(values_ms, 0.99),
          quantile(values_ms, 0.999),
          quantile(values_ms, 1),
          values_ms.size()};
}

namespace {

using Pictures = std::vector<const PictureTimes*>;
using Of = std::function<double(const PictureTimes&)>;

double passes_2_to_4_ms(const PictureTimes& times) {
  double sum_ms = 0;
  for (const render::PassTime& pass : times.passes) {
    if (pass.name != "scan_conversion") sum_ms += pass.ms;
  }
  return sum_ms;
}

class Chain {
 public:
  Chain(const StreamResult& result, StickTimes PictureTimes::*stick) : stick_(stick) {
    for (const PictureTimes& times : result.records) {
      is_scheduled_ = (times.*stick).fired.has_value();
      if ((times.*stick).arrived) pictures_.push_back(&times);
    }
  }

  void add(const std::string& from, const std::string& to, const Of& of) {
    std::vector<double> values_ms;
    for (const PictureTimes* times : pictures_) values_ms.push_back(of(*times));
    spans_.push_back({from, to, /*on_device_clock=*/false, percentiles_of(values_ms)});
  }
  void add_modelled(const std::string& from, const std::string& to, double ms) {
    add(from, to, [ms](const PictureTimes&) { return ms; });
    spans_.back().on_device_clock = true;
  }
  void add_unknown(const std::string& from, const std::string& to) {
    spans_.push_back({from, to, /*on_device_clock=*/false, std::nullopt});
  }
  /// Until the program has the stick.
  void add_acquisition(const std::optional<CardDelay>& card);
  void add_rendering();

  std::vector<LatencySpan> spans() && { return std::move(spans_); }

 private:
  StickTimes PictureTimes::*const stick_;
  bool is_scheduled_ = false;  ///< the link has an epoch
  Pictures pictures_;
  std::vector<LatencySpan> spans_;
};

void Chain::add_acquisition(const std::optional<CardDelay>& card) {
  const auto notified_after_ms = [this](const PictureTimes& times) {
    return to_milliseconds((times.*stick_).received - *(times.*stick_).fired);
  };
  if (!is_scheduled_) {
    add_unknown("emission", "notified");
  } else if (!card) {
    add("emission", "notified", notified_after_ms);
  } else {
    add_modelled("emission", "DMA complete", card->dma_complete_ms);
    add_modelled("DMA complete", "interrupt", card->interrupt_ms - card->dma_complete_ms);
    add("interrupt", "notified", [&](const PictureTimes& times) {
      return notified_after_ms(times) - card->interrupt_ms;
    });
  }
  add("notified", "acquired", [this](const PictureTimes& times) {
    return to_milliseconds((times.*stick_).acquired - (times.*stick_).received);
  });
}

void Chain::add_rendering() {
  add("acquired", "frame complete", [](const PictureTimes& times) {
    return to_milliseconds(times.complete - times.last.acquired);
  });
  add("frame complete", "taken", [](const PictureTimes& times) {
    return to_milliseconds(times.taken - times.complete);
  });
  add("taken", "uploaded", [](const PictureTimes& times) {
    return to_milliseconds(times.uploaded - times.taken) - times.pass_1_ms;
  });
  add("uploaded", "scan_conversion", [](const PictureTimes& times) { return times.pass_1_ms; });
  std::string from = "scan_conversion";
  const std::size_t passes = pictures_.empty() ? 0 : pictures_.front()->passes.size();
  for (std::size_t i = 0; i < passes; ++i) {
    const std::string pass = pictures_.front()->passes[i].name;
    if (pass == "scan_conversion") continue;
    add(from, pass, [i](const PictureTimes& times) { return times.passes.at(i).ms; });
    from = pass;
  }
  add(from, "ready", [](const PictureTimes& times) {
    return to_milliseconds(times.ready - times.uploaded) - passes_2_to_4_ms(times);
  });
}

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

LatencySpans latency_spans(const StreamResult& result, const std::optional<CardDelays>& card) {
  const auto of = [&](CardDelay CardDelays::*stick) {
    return card ? std::optional((*card).*stick) : std::nullopt;
  };
  Chain oldest(result, &PictureTimes::first);
  oldest.add_acquisition(of(&CardDelays::first));
  Chain newest(result, &PictureTimes::last);
  newest.add_acquisition(of(&CardDelays::last));
  newest.add_rendering();
  LatencySpans spans{std::move(oldest).spans(), std::move(newest).spans(), ""};
  if (!spans.newest.front().ms) {
    spans.why_unknown = "the link does not say when a stick is fired, nor what its card does";
  } else if (!card) {
    spans.why_unknown = "the link does not say when DMA is complete and when its card interrupts";
  }
  return spans;
}

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
