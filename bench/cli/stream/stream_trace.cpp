#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/cli/stream/stream_page.h"
#include "bench/cli/stream/stream_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;
using Kind = StreamSpan::Kind;

constexpr int kProcess = 1;

int track_of(Kind kind) {
  return 1 + static_cast<int>(kind);
}

const char* track_name(Kind kind) {
  switch (kind) {
    case Kind::stick_acquired:
      return "board: first and last stick of a frame";
    case Kind::frame_acquired:
      return "board: sticks of a frame";
    case Kind::frame_uploaded:
      return "renderer: upload and pass 1";
    case Kind::picture_rendered:
      return "renderer: passes 2 to 4";
    case Kind::picture_written:
      return "sink: written";
  }
  return "";
}

std::string span_name(const StreamSpan& span) {
  const bool is_frame = span.kind < Kind::picture_rendered;
  const std::string volume = "volume " + std::to_string(span.volume);
  return is_frame ? volume + " frame " + std::to_string(span.frame) : volume;
}

/// Events in microseconds after the stream began.
class Trace {
 public:
  explicit Trace(hw::HostTime begin) : begin_(begin) {}

  void name_track(Kind kind) {
    events_.push_back({{"ph", "M"},
                       {"pid", kProcess},
                       {"tid", track_of(kind)},
                       {"name", "thread_name"},
                       {"args", {{"name", track_name(kind)}}}});
  }
  void add_span(const StreamSpan& span) {
    events_.push_back({{"ph", "X"},
                       {"pid", kProcess},
                       {"tid", track_of(span.kind)},
                       {"name", span_name(span)},
                       {"ts", microseconds(span.begin)},
                       {"dur", microseconds(span.end) - microseconds(span.begin)}});
  }
  void add_counter(const char* name, hw::HostTime at, double value) {
    events_.push_back({{"ph", "C"},
                       {"pid", kProcess},
                       {"name", name},
                       {"ts", microseconds(at)},
                       {"args", {{"value", value}}}});
  }
  /// An arrow from span to span, each of which it binds to by a time inside it.
  void add_arrow(const char* name, const std::vector<const StreamSpan*>& spans) {
    ++arrows_;
    for (const StreamSpan* span : spans) {
      const char* phase = span == spans.front() ? "s" : span == spans.back() ? "f" : "t";
      events_.push_back({{"ph", phase},
                         {"pid", kProcess},
                         {"tid", track_of(span->kind)},
                         {"id", arrows_},
                         {"name", name},
                         {"cat", "echo"},
                         {"bp", "e"},
                         {"ts", middle(*span)}});
    }
  }
  std::string text() const {
    return Json{{"displayTimeUnit", "ms"}, {"traceEvents", events_}}.dump() + "\n";
  }

 private:
  double microseconds(hw::HostTime time) const {
    return std::chrono::duration<double, std::micro>(time - begin_).count();
  }
  double middle(const StreamSpan& span) const {
    return 0.5 * (microseconds(span.begin) + microseconds(span.end));
  }

  hw::HostTime begin_;
  Json events_ = Json::array();
  int arrows_ = 0;
};

/// The spans of one stream by what they are of, each kind in the order of time.
class SpansByKind {
 public:
  explicit SpansByKind(const std::vector<StreamSpan>& spans) {
    for (const StreamSpan& span : spans) {
      if (span.kind == Kind::frame_uploaded) uploads_[{span.volume, span.frame}] = &span;
      if (span.kind == Kind::picture_rendered) pictures_.push_back(&span);
    }
  }
  const StreamSpan* upload_of(const StreamSpan& stick) const {
    const auto upload = uploads_.find({stick.volume, stick.frame});
    return upload == uploads_.end() ? nullptr : upload->second;
  }
  /// The first picture that shows the frame.
  const StreamSpan* picture_after(const StreamSpan& upload) const {
    const auto picture = std::ranges::lower_bound(
        pictures_, upload.end, {}, [](const StreamSpan* of) { return of->begin; });
    return picture == pictures_.end() ? nullptr : *picture;
  }
  /// The picture that the sink took: the newest of the volume.
  const StreamSpan* picture_before(const StreamSpan& written) const {
    const auto after = std::ranges::upper_bound(
        pictures_, written.begin, {}, [](const StreamSpan* of) { return of->end; });
    for (auto picture = after; picture != pictures_.begin();) {
      if ((*--picture)->volume == written.volume) return *picture;
    }
    return nullptr;
  }

 private:
  std::map<std::pair<std::uint32_t, int>, const StreamSpan*> uploads_;
  std::vector<const StreamSpan*> pictures_;
};

/// How many frames wait for the renderer, after each that comes and each that it takes. Those of a
/// volume that a later one has overtaken wait no more.
void add_queue(const std::vector<StreamSpan>& spans, Trace& trace) {
  std::multimap<hw::HostTime, const StreamSpan*> events;
  for (const StreamSpan& span : spans) {
    if (span.kind == Kind::frame_acquired) events.emplace(span.end, &span);
    if (span.kind == Kind::frame_uploaded) events.emplace(span.begin, &span);
  }
  std::map<std::uint32_t, int> waiting;
  for (const auto& [at, span] : events) {
    waiting[span->volume] += span->kind == Kind::frame_acquired ? 1 : -1;
    if (span->kind == Kind::frame_uploaded) {
      waiting.erase(waiting.begin(), waiting.lower_bound(span->volume));
    }
    int frames = 0;
    for (const auto& [volume, count] : waiting) frames += count;
    trace.add_counter("frames in the queue", at, frames);
  }
}

/// Of each picture when it was ready.
void add_ages(const std::deque<PictureTimes>& pictures, Trace& trace) {
  for (const PictureTimes& picture : pictures) {
    const auto age = [&](const StickTimes& of) {
      return age_ms(of, picture, of.fired.has_value());
    };
    trace.add_counter("age of the newest echo, ms", picture.ready, age(picture.last));
    trace.add_counter("age of the oldest echo, ms", picture.ready, age(picture.first));
  }
}

}  // namespace

std::string stream_trace(const StreamResult& result) {
  Trace trace(result.begin);
  for (const Kind kind : {Kind::stick_acquired,
                          Kind::frame_acquired,
                          Kind::frame_uploaded,
                          Kind::picture_rendered,
                          Kind::picture_written}) {
    trace.name_track(kind);
  }
  std::vector<StreamSpan> spans = result.spans;
  std::ranges::stable_sort(spans, {}, &StreamSpan::begin);
  const SpansByKind by_kind(spans);
  for (const StreamSpan& span : spans) {
    trace.add_span(span);
    if (span.kind == Kind::stick_acquired) {
      const StreamSpan* upload = by_kind.upload_of(span);
      const StreamSpan* picture = upload == nullptr ? nullptr : by_kind.picture_after(*upload);
      if (picture != nullptr) trace.add_arrow("shown in", {&span, upload, picture});
    } else if (span.kind == Kind::picture_written) {
      const StreamSpan* picture = by_kind.picture_before(span);
      if (picture != nullptr) trace.add_arrow("written", {picture, &span});
    }
  }
  add_queue(spans, trace);
  add_ages(result.records, trace);
  return trace.text();
}

}  // namespace wobblebench::bench
