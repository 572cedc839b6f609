#include "hw/recording/recording.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "hw/recording/recording_reader.h"
#include "hw/wire/packet.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {

namespace {

constexpr std::uint64_t kProgressBytes = 16 << 20;

template <class T>
void append_fault(std::vector<T>& faults, const T& fault) {
  if (faults.size() < RecordingContents::kListedFaults) faults.push_back(fault);
}

/// Compares the times of an acquisition's sticks with its plan. Seconds, as the difference of two
/// times may have no number of nanoseconds.
class TimesByPlan {
 public:
  explicit TimesByPlan(const AcquisitionPlan& plan) : plan_(plan) {}

  /// By how much the stick's time leaves the plan, where it did not before, s; none: it does not.
  std::optional<double> jump_s(const Stick& stick) {
    const long double late_ns =
        static_cast<long double>(stick.time.time_since_epoch().count()) -
        static_cast<long double>(plan_.stick_time(stick.sequence).time_since_epoch().count());
    if (!late_ns_) late_ns_ = late_ns;
    const auto jump_s = static_cast<double>((late_ns - *late_ns_) * 1e-9L);
    if (std::abs(jump_s) <= 0.5 * plan_.stick_period_s()) return {};
    late_ns_ = late_ns;
    return jump_s;
  }

 private:
  AcquisitionPlan plan_;
  std::optional<long double> late_ns_;  ///< at the first stick, or at the last jump
};

/// Fills RecordingContents from the packets of a recording.
class Inspection {
 public:
  explicit Inspection(RecordingContents& contents) : contents_(contents) {}

  void damage_before(std::uint64_t offset, std::uint64_t bytes) {
    if (bytes == 0) return;
    audit_.note_damage();
    append_fault(contents_.damaged_regions, {offset - bytes, bytes});
  }

  void take(const Packet& packet, std::uint64_t offset) {
    offset_ = offset;
    std::visit([this](const auto& kind) { take_kind(kind); }, packet);
  }

  void finish() { contents_.account = audit_.account(); }

 private:
  void take_kind(const ConfigurationPacket& packet) {
    const AuditResult result = audit_.take(packet);
    ++contents_.configurations;
    note(result);
    if (result.accepted) begin_acquisition(packet.volume);
  }

  void take_kind(const StickPacket& packet) {
    ++contents_.sticks;
    const AuditResult result = audit_.take(packet.stick);
    note(result);
    if (result.accepted) {
      audit_.deliver();
      ++volume(packet.stick.index.volume).sticks;
      if (RecordedAcquisition* acquisition = listed_acquisition()) {
        ++acquisition->sticks;
        acquisition->motor.add(
            audit_.configuration()->plan, packet.stick.index, packet.stick.motor_angle_rad);
      }
      if (const auto later_s = times_->jump_s(packet.stick)) {
        ++contents_.time_jump_count;
        append_fault(contents_.time_jumps, {offset_, packet.stick.sequence, *later_s});
      }
    } else if (!audit_.configuration()) {
      ++contents_.unconfigured;
    }
  }

  void take_kind(const VolumeEndPacket& packet) {
    ++contents_.volume_ends;
    const AuditResult result = audit_.take(packet);
    note(result);
    if (result.accepted) volume(packet.volume).closed = true;
  }

  void note(const AuditResult& result) {
    if (result.missing) append_gap(*result.missing);
    if (result.rejected) append_gap(*result.rejected);
    if (result.contradicts) ++contents_.contradictions;
  }

  /// Joins adjacent gaps of one cause.
  void append_gap(const Gap& gap) {
    if (!contents_.gaps.empty()) {
      Gap& last = contents_.gaps.back();
      const bool is_adjacent = last.first_sequence + last.count == gap.first_sequence;
      if (is_adjacent && last.cause == gap.cause) {
        last.count += gap.count;
        return;
      }
    }
    append_fault(contents_.gaps, gap);
  }

  void begin_acquisition(std::uint32_t volume) {
    const Configuration& configuration = audit_.configuration().value();
    if (!contents_.configuration) contents_.configuration = configuration;
    ++contents_.acquisition_count;
    append_fault(contents_.acquisitions, {configuration, offset_, volume});
    times_.emplace(configuration.plan);
  }

  /// The one under way; null: there is none, or it is not listed.
  RecordedAcquisition* listed_acquisition() {
    const bool is_listed = contents_.acquisition_count == contents_.acquisitions.size();
    return is_listed && !contents_.acquisitions.empty() ? &contents_.acquisitions.back() : nullptr;
  }

  RecordedVolume& volume(std::uint32_t index) {
    const std::uint64_t acquisition = contents_.acquisition_count;
    const bool is_new = contents_.volumes.empty() || contents_.volumes.back().index != index ||
                        contents_.volumes.back().acquisition != acquisition;
    if (is_new) {
      const auto& configuration = audit_.configuration();
      const auto expected = configuration ? configuration->plan.sticks_per_volume() : 0;
      contents_.volumes.push_back({.index = index,
                                   .acquisition = acquisition,
                                   .expected = static_cast<std::uint64_t>(expected)});
      if (RecordedAcquisition* listed = listed_acquisition()) ++listed->volumes;
    }
    return contents_.volumes.back();
  }

  RecordingContents& contents_;
  StreamAudit audit_;
  std::optional<TimesByPlan> times_;  ///< of the acquisition under way
  std::uint64_t offset_ = 0;          ///< of the packet that is taken
};

struct FirstConfiguration {
  ConfigurationPacket packet;
  bool begins_anew = false;  ///< the sticks before it are of another acquisition
};

/// Of a recording, at any offset before an unreadable place.
std::optional<FirstConfiguration> first_configuration(const RecordingFile& file) {
  RecordingReader reader(file);
  StreamAudit audit;
  try {
    while (const auto recorded = reader.next()) {
      if (!recorded->packet) continue;
      if (const auto* stick = std::get_if<StickPacket>(&*recorded->packet)) {
        audit.take(stick->stick);
      } else if (const auto* end = std::get_if<VolumeEndPacket>(&*recorded->packet)) {
        audit.take(*end);
      } else if (const auto* packet = std::get_if<ConfigurationPacket>(&*recorded->packet)) {
        const std::uint64_t before = audit.next_sequence();
        audit.take(*packet);  // throws if it is not possible
        return FirstConfiguration{*packet, audit.next_sequence() < before};
      }
    }
  } catch (const UnreadableStream&) {
    // Nothing that follows can be interpreted.
  }
  return {};
}

/// Copies intact packets, and writes a configuration before each volume.
class Salvage {
 public:
  Salvage(const FirstConfiguration& first,
          const std::function<void(std::span<const std::byte>)>& sink)
      : configuration_(first.packet), holds_before_(!first.begins_anew), sink_(sink) {}

  void damage() { audit_.note_damage(); }

  void take(const Packet& packet, std::span<const std::byte> bytes) {
    if (const auto* configuration = std::get_if<ConfigurationPacket>(&packet)) {
      take_configuration(*configuration, bytes);
    } else if (const auto* stick = std::get_if<StickPacket>(&packet)) {
      take_stick(stick->stick, bytes);
    } else {
      const auto& end = std::get<VolumeEndPacket>(packet);
      if (!started_ || !audit_.take(end).accepted) return;
      if (configured_volume_ != end.volume) return;
      sink_(bytes);
    }
  }

 private:
  /// Starts the audit with a configuration. All configurations of an acquisition are equal, so that
  /// a later one holds for packets before it.
  void start_audit(std::uint64_t sequence, std::uint32_t volume, DeviceTime time) {
    if (started_) return;
    started_ = true;
    ConfigurationPacket packet = configuration_;
    packet.sequence = sequence;
    packet.volume = volume;
    packet.time = time;
    audit_.take(packet);
  }

  void take_configuration(const ConfigurationPacket& packet, std::span<const std::byte> bytes) {
    start_audit(packet.sequence, packet.volume, packet.time);
    const AuditResult result = audit_.take(packet);
    if (!result.accepted && (result.contradicts || configured_volume_ == packet.volume)) return;
    configuration_ = packet;
    configured_volume_.reset();
    if (result.contradicts) return;  // The next stick's number is written instead of its own.
    configured_volume_ = packet.volume;
    sink_(bytes);
  }

  void take_stick(const Stick& stick, std::span<const std::byte> bytes) {
    if (!started_ && !holds_before_) return;
    start_audit(stick.sequence, stick.index.volume, stick.time);
    if (!audit_.take(stick).accepted) return;
    audit_.deliver();
    if (configured_volume_ != stick.index.volume) write_configuration(stick);
    sink_(bytes);
  }

  void write_configuration(const Stick& stick) {
    configuration_.sequence = stick.sequence;
    configuration_.volume = stick.index.volume;
    configuration_.time = stick.time;
    std::vector<std::byte> bytes;
    encode(configuration_, bytes);
    sink_(bytes);
    configured_volume_ = stick.index.volume;
  }

  ConfigurationPacket configuration_;
  const bool holds_before_;  ///< the configuration, for the sticks before it
  const std::function<void(std::span<const std::byte>)>& sink_;
  StreamAudit audit_;
  bool started_ = false;
  std::optional<std::uint32_t> configured_volume_;
};

}  // namespace

bool RecordingContents::complete() const {
  if (!configuration || account.lost.total() > 0) return false;
  return std::all_of(
      volumes.begin(), volumes.end(), [](const RecordedVolume& volume) { return volume.whole(); });
}

RecordingContents inspect_recording(const std::filesystem::path& path,
                                    const std::function<void(std::uint64_t)>& progress) {
  const RecordingFile file(path);
  RecordingContents contents;
  contents.bytes = file.bytes();
  Inspection inspection(contents);
  RecordingReader reader(file);
  std::uint64_t next_progress = kProgressBytes;
  contents.unreadable = for_each_packet(reader, [&](const RecordedPacket& recorded) {
    inspection.damage_before(recorded.offset, recorded.damage_before);
    if (recorded.packet) {
      inspection.take(*recorded.packet, recorded.offset);
    } else {
      ++contents.other_packets;
    }
    if (progress && recorded.offset >= next_progress) {
      progress(recorded.offset);
      next_progress += kProgressBytes;
    }
  });
  const std::uint64_t end = contents.unreadable ? contents.unreadable->offset : file.bytes();
  inspection.damage_before(end, end - std::min(end, reader.end()));
  contents.damage = reader.damage();
  inspection.finish();
  return contents;
}

void salvage_recording(const std::filesystem::path& path,
                       const std::function<void(std::span<const std::byte>)>& sink) {
  const RecordingFile file(path);
  const auto configuration = first_configuration(file);
  if (!configuration) {
    throw std::runtime_error(path.string() +
                             ": holds no configuration; no stick can be interpreted");
  }
  Salvage salvage(*configuration, sink);
  RecordingReader reader(file);
  for_each_packet(reader, [&](const RecordedPacket& recorded) {
    if (recorded.damage_before > 0) salvage.damage();
    if (recorded.packet) salvage.take(*recorded.packet, recorded.bytes);
  });
}

}  // namespace wobblebench::hw
