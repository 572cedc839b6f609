// The age of an echo, taken apart: from its scheduled emission to the picture that shows it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/stream/percentiles.h"
#include "bench/pipeline/stream/stream.h"

namespace wobblebench::bench {

/// By a model of the card, after a stick was fired; the same in each volume. On the device's clock.
struct CardDelay {
  double dma_complete_ms = 0;  ///< its last byte lies in the host's memory
  double interrupt_ms = 0;     ///< that announces it
};
/// Of a volume's first and last stick.
struct CardDelays {
  CardDelay first, last;
};

/// On one clock. Where `from` is on the device's and `to` on the host's, the link's epoch says what
/// `from` is on the host's.
struct LatencySpan {
  std::string from, to;
  bool on_device_clock = false;
  std::optional<Percentiles> ms;  ///< none: the link does not tell
};

/// Spans that follow each other. Only of sticks that arrived.
struct LatencySpans {
  std::vector<LatencySpan> oldest;  ///< of a volume's first stick, until it is acquired
  std::vector<LatencySpan> newest;  ///< of its last one, until the picture is ready
  std::string why_unknown;          ///< empty: all are known
};

/// `card`: none: the link has no model of one, or pictures show parts of a volume.
LatencySpans latency_spans(const StreamResult& result, const std::optional<CardDelays>& card);

}  // namespace wobblebench::bench
