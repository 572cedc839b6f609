// A recording as a board's link.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "hw/link/link.h"
#include "hw/link/pace.h"
#include "hw/link/waiting.h"
#include "hw/probe/acquisition_plan.h"
#include "hw/recording/recording_reader.h"

namespace wobblebench::hw {

struct FileLinkOptions {
  Pace pace = Pace::asap;
  /// Begin again after the end, for ever: numbers and times go on as if the probe went on.
  bool loop = false;
  int start_volume = 0;  ///< begin at this volume's configuration
};

template <OptionsOf<FileLinkOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  describe_pace(o.pace, v);
  v.flag("loop", o.loop);
  v.integer("start_volume", o.start_volume, 0, 1 << 30);
}

/// Gives the file's bytes as they are, damage too; while looping, packets are restamped. It waits
/// for its reader at either pace.
class FileLink : public Link {
 public:
  /// Throws LinkOpenError; InvalidOption for a volume that the recording does not hold, and for a
  /// loop over a recording that cannot go on after its end.
  explicit FileLink(const std::filesystem::path& path, const FileLinkOptions& options = {});

  ReadResult read(std::span<std::byte> buffer, HostTime deadline) override;
  void cancel() override { waiting_.cancel(); }
  void resume() override { waiting_.resume(); }
  void close() override { waiting_.close(); }
  LinkCapabilities capabilities() const override;
  std::string loss() const override { return loss_.empty() ? Link::loss() : loss_; }

 private:
  /// One turn of the loop, and all turns done: what is added to each stamp.
  struct Turn {
    std::uint64_t sticks = 0;
    std::uint32_t volumes = 0;
  };

  std::uint64_t find_volume(std::uint32_t volume) const;
  Turn measure_turn();
  ReadResult read_raw(std::span<std::byte> buffer);
  ReadResult read_packets(std::span<std::byte> buffer, HostTime deadline);
  bool take_packet();
  void take_end();
  HostTime due(DeviceTime time);

  const FileLinkOptions options_;
  const RecordingFile file_;
  Waiting waiting_;
  std::string loss_;
  std::uint64_t start_ = 0;     ///< of the first packet, in the file
  std::uint64_t offset_ = 0;    ///< of the next byte that is given as it is …
  std::uint64_t as_it_is_ = 0;  ///< … and how many are, before packet_
  Turn turn_;                   ///< of the loop
  Turn done_;
  std::optional<AcquisitionPlan> plan_;    ///< while looping
  std::optional<RecordingReader> reader_;  ///< none: the end was reached
  std::vector<std::byte> packet_;
  std::size_t given_ = 0;  ///< bytes of packet_
  HostTime packet_due_{};
  struct Epoch {
    HostTime host;
    DeviceTime device;
  };
  std::optional<Epoch> epoch_;
};

}  // namespace wobblebench::hw
