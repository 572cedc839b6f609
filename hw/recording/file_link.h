// A link that reads a recording.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/options.h"
#include "hw/link/link.h"

namespace wobblebench::hw {

struct FileLinkOptions {
  Pace pace = Pace::asap;
  /// Repeat without end; sequence numbers, volumes and times continue from one repetition to the
  /// next.
  bool loop = false;
  int acquisition = 0;   ///< this one alone, counted from 1; 0: all
  int start_volume = 0;  ///< starts at this volume's configuration; 0: with the first byte
};

template <OptionsOf<FileLinkOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  describe_pace(o.pace, v);
  v.flag("loop", o.loop);
  v.integer("acquisition", o.acquisition, 0, 1 << 30);
  v.integer("start_volume", o.start_volume, 0, 1 << 30);
}

/// Delivers the file's bytes unchanged, damage included; in a loop, packets get new sequence
/// numbers, volumes and times. Waits for its reader at either pace: in real time its clock starts
/// with the first read, and stands from cancel() to the first read after resume().
///
/// In real time a packet is due when the acquisition plan says, whatever time it carries: a
/// device's clock may jump. Of a gap of more than 10 s the rest is left out, and acquisitions
/// follow each other after 0.1 s.
///
/// @code
/// #include "hw/board/board.h"
/// hw::FileLinkOptions options;
/// options.pace = hw::Pace::realtime;
/// options.loop = true;
/// hw::Board board(std::make_unique<hw::FileLink>("scan.wbst", options));
/// board.start();
/// const hw::Event first = board.next(hw::HostTime::max());
/// if (std::holds_alternative<hw::EndOfStream>(first)) board.close();
/// @endcode
class FileLink : public Link {
 public:
  /// Throws LinkOpenError; InvalidOption for an acquisition or a volume that the recording does not
  /// hold, for a loop over a recording that cannot be repeated, and for real time where its times
  /// are not known.
  explicit FileLink(const std::filesystem::path& path, const FileLinkOptions& options = {});
  ~FileLink() override;

  ReadResult read(std::span<std::byte> buffer, HostTime deadline) override;
  void cancel() override;
  void resume() override;
  void close() override;
  LinkCapabilities capabilities() const override;
  std::optional<HostTime> epoch() const override;
  std::string loss() const override;

 private:
  class Impl;

  const std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::hw
