#include "bench/studies/latency/service_times.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>

#include "base/duration.h"
#include "base/file.h"
#include "base/user_error.h"
#include "bench/studies/latency/virtual_stream.h"
#include "hw/wire/packet.h"
#include "sim/card/card_model.h"

namespace wobblebench::bench {

namespace {

/// Sends the packets of a volume, and reads the card at each of its interrupts.
class OneVolume {
 public:
  OneVolume(const hw::AcquisitionPlan& plan, const sim::CardOptions& options)
      : plan_(plan), card_(options), buffer_(1 << 16) {
    stick_.samples.resize(static_cast<std::size_t>(plan.acquisition().samples_per_stick));
  }

  std::vector<CardTimes> run() {
    send(hw::ConfigurationPacket{.source = hw::StreamOrigin::simulated,
                                 .probe = plan_.probe(),
                                 .acquisition = plan_.acquisition()},
         hw::DeviceTime{});
    for (int stick = 0; stick < plan_.sticks_per_volume(); ++stick) {
      send(stick_, end_of(stick));
      times_.push_back({to_seconds(card_.transfer_end().time_since_epoch()), 0});
      ends_.push_back(sent_);
    }
    send(hw::VolumeEndPacket{}, end_of(plan_.sticks_per_volume() - 1), /*ends_volume=*/true);
    read_until(hw::DeviceTime::max());
    return std::move(times_);
  }

 private:
  hw::DeviceTime end_of(int stick) const {
    return hw::DeviceTime(
        hw::DeviceDuration(std::llround((stick + 1) * plan_.stick_period_s() * 1e9)));
  }

  template <class Sent>
  void send(const Sent& packet, hw::DeviceTime at, bool ends_volume = false) {
    read_until(at);
    packet_.clear();
    hw::encode(packet, packet_);
    sent_ += packet_.size();
    card_.push(packet_, at, ends_volume);
  }

  void read_until(hw::DeviceTime until) {
    while (const auto interrupt = card_.next_interrupt()) {
      if (*interrupt > until) return;
      read_ += card_.read(buffer_, *interrupt);
      for (; announced_ < ends_.size() && ends_[announced_] <= read_; ++announced_) {
        times_[announced_].interrupt_s = to_seconds(interrupt->time_since_epoch());
      }
    }
  }

  const hw::AcquisitionPlan& plan_;
  sim::CardModel card_;
  hw::Stick stick_;
  std::vector<std::byte> buffer_, packet_;
  std::vector<CardTimes> times_;
  std::vector<std::size_t> ends_;  ///< bytes sent up to the end of each stick's packet
  std::size_t sent_ = 0, read_ = 0, announced_ = 0;
};

}  // namespace

std::vector<CardTimes> card_times(const hw::AcquisitionPlan& plan, const sim::CardOptions& card) {
  return OneVolume(plan, card).run();
}

std::vector<double> frame_announcements_s(const hw::AcquisitionPlan& plan,
                                          const sim::CardOptions& card) {
  const auto times = card_times(plan, card);
  const auto lines = static_cast<std::size_t>(plan.acquisition().sticks_per_frame);
  std::vector<double> frames_s;
  for (std::size_t end = lines; end <= times.size(); end += lines) {
    frames_s.push_back(times[end - 1].interrupt_s);
  }
  return frames_s;
}

CardDelays card_delays(const hw::AcquisitionPlan& plan, const sim::CardOptions& card) {
  const auto times = card_times(plan, card);
  const double last_s = (plan.sticks_per_volume() - 1) * plan.stick_period_s();
  const auto after = [](const CardTimes& of, double fired_s) {
    return CardDelay{1e3 * (of.dma_complete_s - fired_s), 1e3 * (of.interrupt_s - fired_s)};
  };
  return {after(times.front(), 0), after(times.back(), last_s)};
}

namespace {

/// Linear in `share`, 0 to 1 from the first value to the second; not negative beyond.
double between(double one, double other, double share) {
  return std::max(std::lerp(one, other, share), 0.0);
}

TimePool with_mean(const TimePool& pool, double mean) {
  return pool.mean() > 0 ? pool.scaled(mean / pool.mean()) : pool;
}

void add_span(ServiceTimes& times, const StreamSpan& span, const hw::AcquisitionPlan& plan) {
  const bool back = plan.sweep_direction(span.volume) < 0;
  const bool is_last = span.frame == (back ? 0 : plan.acquisition().frames_per_volume - 1);
  const double took = to_seconds(span.end - span.begin);
  switch (span.kind) {
    case StreamSpan::Kind::frame_uploaded:
      (is_last ? times.last_frame : times.frame).values.push_back(took);
      break;
    case StreamSpan::Kind::picture_rendered:
      times.picture.values.push_back(took);
      break;
    case StreamSpan::Kind::picture_written:
      times.written.values.push_back(took);
      break;
    case StreamSpan::Kind::stick_acquired:
    case StreamSpan::Kind::frame_acquired:
      break;
  }
}

}  // namespace

double TimePool::mean() const {
  if (values.empty()) return 0;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double TimePool::at(double share, std::uint64_t behind) const {
  if (values.empty()) return 0;
  const auto first = static_cast<std::uint64_t>(share * static_cast<double>(values.size()));
  return values[(first + behind) % values.size()];
}

TimePool TimePool::scaled(double factor) const {
  TimePool pool = *this;
  for (double& value : pool.values) value *= factor;
  return pool;
}

double ServiceTimes::renderer_s(int frames) const {
  return (frames - 1) * frame.mean() + last_frame.mean() + picture.mean();
}

ServiceTimes measured_times(const std::vector<StreamResult>& rounds,
                            const hw::AcquisitionPlan& plan,
                            const sim::CardOptions& card) {
  const double announced_s = frame_announcements_s(plan, card).back();
  const double last_fired_s = (plan.sticks_per_volume() - 1) * plan.stick_period_s();
  ServiceTimes times;
  for (const StreamResult& result : rounds) {
    for (const StreamSpan& span : result.spans) add_span(times, span, plan);
    for (const PictureTimes& picture : result.records) {
      if (!picture.last.fired) continue;
      const double took = to_seconds(picture.last.acquired - *picture.last.fired);
      times.wake.values.push_back(std::max(took - (announced_s - last_fired_s), 0.0));
    }
  }
  return times;
}

KnownTimes paper_times() {
  constexpr double kFrame_s = (54.6e-3 - 53.7e-3) / (37 - 27);
  const ServiceTimes times{.wake = {},
                           .frame = {{kFrame_s}},
                           .last_frame = {{kFrame_s}},
                           .picture = {{54.6e-3 - 37 * kFrame_s}},
                           .written = {}};
  return {"paper", times, 37, times, 27};
}

ServiceTimes KnownTimes::at(int frames) const {
  const double share =
      static_cast<double>(frames - frames_of_one) / (frames_of_other - frames_of_one);
  // Pass 1 of a volume but for its last frame, in all.
  const double all = between(
      (frames_of_one - 1) * one.frame.mean(), (frames_of_other - 1) * other.frame.mean(), share);
  const auto linear = [&](const TimePool& of_one, const TimePool& of_other) {
    return with_mean(of_one, between(of_one.mean(), of_other.mean(), share));
  };
  return {.wake = one.wake,
          .frame = with_mean(one.frame, frames > 1 ? all / (frames - 1) : 0),
          .last_frame = linear(one.last_frame, other.last_frame),
          .picture = linear(one.picture, other.picture),
          .written = one.written};
}

namespace {

using Json = nlohmann::ordered_json;

/// Milliseconds in the report, seconds in the pool. Throws std::invalid_argument.
TimePool pool_of(const Json& stage, const char* key) {
  TimePool pool;
  for (const Json& ms : stage.at(key)) {
    const double value = ms.get<double>();
    if (!std::isfinite(value) || value < 0) {
      throw std::invalid_argument(std::string(key) + " holds what is no time");
    }
    pool.values.push_back(1e-3 * value);
  }
  if (pool.values.empty()) throw std::invalid_argument(std::string(key) + " is empty");
  return pool;
}

/// Both numbers of frames of one setting, the greater one first.
KnownTimes known_of(const Json& stages, const std::string& settings, const std::string& renderer) {
  KnownTimes known{.name = renderer + ", " + settings, .one = {}, .other = {}};
  for (const Json& stage : stages) {
    if (stage.at("settings") != settings) continue;
    const bool is_one = known.frames_of_one == 0;
    (is_one ? known.frames_of_one : known.frames_of_other) = stage.at("frames");
    (is_one ? known.one : known.other) = {.wake = {},
                                          .frame = pool_of(stage, "frame_ms"),
                                          .last_frame = pool_of(stage, "last_frame_ms"),
                                          .picture = pool_of(stage, "picture_ms"),
                                          .written = {}};
  }
  if (known.frames_of_other < 2 || known.frames_of_one <= known.frames_of_other) {
    throw std::invalid_argument("has not two numbers of frames of the settings " + settings);
  }
  return known;
}

}  // namespace

std::vector<KnownTimes> read_known_times(const std::filesystem::path& file) {
  try {
    const Json report = Json::parse(read_file(file));
    const Json& stages = report.at("timing").at("stages");
    std::string renderer = report.at("provenance").at("gl_renderer");
    renderer = renderer.substr(0, renderer.find_first_of(",/"));
    return {known_of(stages, "paper", renderer), known_of(stages, "default", renderer)};
  } catch (const std::exception& error) {
    throw UserError("--times = " + file.string() +
                    ": must be report.json of `tables` or script/gpu: " + error.what());
  }
}

}  // namespace wobblebench::bench
