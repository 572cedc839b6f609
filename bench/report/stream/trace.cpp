#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/report/stream/stream_report.h"

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
  const bool is_frame = span.kind == Kind::frame_acquired || span.kind == Kind::frame_uploaded;
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
  /// An arrow between two spans, which it binds to by a time inside them.
  void add_arrow(const StreamSpan& from, const StreamSpan& to) {
    const int id = ++arrows_;
    events_.push_back(arrow_end("s", id, from.kind, middle(from)));
    Json end = arrow_end("f", id, to.kind, middle(to));
    end["bp"] = "e";
    events_.push_back(std::move(end));
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
  static Json arrow_end(const char* phase, int id, Kind kind, double at_us) {
    return {{"ph", phase},
            {"pid", kProcess},
            {"tid", track_of(kind)},
            {"id", id},
            {"name", "shown in"},
            {"cat", "echo"},
            {"ts", at_us}};
  }

  hw::HostTime begin_;
  Json events_ = Json::array();
  int arrows_ = 0;
};

}  // namespace

std::string stream_trace(const StreamResult& result) {
  Trace trace(result.begin);
  for (const Kind kind : {Kind::frame_acquired,
                          Kind::frame_uploaded,
                          Kind::picture_rendered,
                          Kind::picture_written}) {
    trace.name_track(kind);
  }
  std::vector<StreamSpan> spans = result.spans;
  std::ranges::sort(spans, {}, &StreamSpan::begin);
  std::map<std::pair<std::uint32_t, int>, StreamSpan> uploads;
  std::map<std::uint32_t, StreamSpan> pictures;  ///< the first that shows all of the volume
  for (const StreamSpan& span : spans) {
    trace.add_span(span);
    if (span.kind == Kind::frame_uploaded) uploads.insert({{span.volume, span.frame}, span});
    if (span.kind == Kind::picture_rendered) pictures.insert_or_assign(span.volume, span);
  }
  for (const StreamSpan& span : spans) {
    if (span.kind == Kind::frame_acquired) {
      const auto upload = uploads.find({span.volume, span.frame});
      if (upload != uploads.end()) trace.add_arrow(span, upload->second);
    }
    const auto picture = pictures.find(span.volume);
    if (picture == pictures.end()) continue;
    if (span.kind == Kind::frame_uploaded && span.end <= picture->second.begin) {
      trace.add_arrow(span, picture->second);
    } else if (span.kind == Kind::picture_written && span.begin >= picture->second.end) {
      trace.add_arrow(picture->second, span);
    }
  }
  return trace.text();
}

}  // namespace wobblebench::bench
