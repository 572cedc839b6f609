#include <variant>

#include "hw/recording/recording.h"
#include "hw/recording/recording_reader.h"
#include "hw/wire/packet.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {
namespace {

/// The first configuration of a recording, at any offset before an unreadable place.
std::optional<ConfigurationPacket> first_configuration(const RecordingFile& file) {
  RecordingReader reader(file);
  try {
    while (const auto recorded = reader.next()) {
      if (!recorded->packet) continue;
      const auto* packet = std::get_if<ConfigurationPacket>(&*recorded->packet);
      if (packet == nullptr) continue;
      StreamAudit().take(*packet);  // throws if it is not possible
      return *packet;
    }
  } catch (const UnreadableStream&) {
    // Nothing that follows can be interpreted.
  }
  return {};
}

/// Copies intact packets, and writes a configuration before each volume.
class Salvage {
 public:
  Salvage(const ConfigurationPacket& first,
          const std::function<void(std::span<const std::byte>)>& sink)
      : configuration_(first), sink_(sink) {}

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
  /// Starts the audit with a configuration. All configurations of a stream are equal, so that a
  /// later one holds for packets before it.
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
  const std::function<void(std::span<const std::byte>)>& sink_;
  StreamAudit audit_;
  bool started_ = false;
  std::optional<std::uint32_t> configured_volume_;
};

}  // namespace

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
