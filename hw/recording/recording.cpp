#include "hw/recording/recording.h"

#include <algorithm>

#include "hw/recording/recording_reader.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {
namespace {

constexpr std::uint64_t kProgressBytes = 16 << 20;

template <class T>
void append_fault(std::vector<T>& faults, const T& fault) {
  if (faults.size() < RecordingContents::kListedFaults) faults.push_back(fault);
}

/// Fills RecordingContents from the packets of a recording.
class Inspection {
 public:
  explicit Inspection(RecordingContents& contents) : contents_(contents) {}

  void damage_before(std::uint64_t offset, std::uint64_t bytes) {
    if (bytes == 0) return;
    audit_.note_damage();
    append_fault(contents_.damaged_regions, {offset - bytes, bytes});
  }

  void take(const Packet& packet) {
    std::visit([this](const auto& kind) { take_kind(kind); }, packet);
  }

  void finish() { contents_.account = audit_.account(); }

 private:
  void take_kind(const ConfigurationPacket& packet) {
    const AuditResult result = audit_.take(packet);
    ++contents_.configurations;
    note(result);
    if (result.accepted && contents_.configuration) contents_.one_plan = false;
    if (!contents_.configuration) contents_.configuration = audit_.configuration();
  }

  void take_kind(const StickPacket& packet) {
    ++contents_.sticks;
    const AuditResult result = audit_.take(packet.stick);
    note(result);
    if (result.accepted) {
      audit_.deliver();
      ++volume(packet.stick.index.volume).sticks;
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
    if (result.missing) append_fault(contents_.gaps, *result.missing);
    if (result.rejected) append_fault(contents_.gaps, *result.rejected);
    if (result.contradicts) ++contents_.contradictions;
  }

  RecordedVolume& volume(std::uint32_t index) {
    if (contents_.volumes.empty() || contents_.volumes.back().index != index) {
      contents_.volumes.push_back({.index = index});
    }
    return contents_.volumes.back();
  }

  RecordingContents& contents_;
  StreamAudit audit_;
};

}  // namespace

bool RecordingContents::complete() const {
  if (!configuration || account.lost.total() > 0) return false;
  const auto expected = static_cast<std::uint64_t>(configuration->plan.sticks_per_volume());
  return std::all_of(volumes.begin(), volumes.end(), [&](const RecordedVolume& volume) {
    return volume.closed && (!one_plan || volume.sticks == expected);
  });
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
      inspection.take(*recorded.packet);
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

}  // namespace wobblebench::hw
