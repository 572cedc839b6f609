#include "bench/pipeline/stream/latency_spans.h"

#include <chrono>
#include <functional>

namespace wobblebench::bench {

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

}  // namespace wobblebench::bench
