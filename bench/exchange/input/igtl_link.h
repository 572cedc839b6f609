// A link to a server of OpenIGTLink: images that it sends, as the sticks of hardware
// (docs/exchange.md).
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "base/options.h"
#include "hw/link/link.h"

namespace wobblebench::bench {

class LeftOut;

/// Which plane of the fan a plane without a number is.
enum class PlaneOrder {
  numbered,  ///< such planes are refused
  in_order   ///< the first that comes is frame 0, and so on
};

struct IgtlLinkOptions {
  std::string device;  ///< whose images are taken; empty: the first that sends a grey one
  PlaneOrder planes = PlaneOrder::numbered;
  double period_s = 0;  ///< from one image to the next, to count those lost by time stamps; 0: none
  double patience_s = 30;  ///< without an image, after which the server counts as lost
};

template <OptionsOf<IgtlLinkOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.text("device", o.device);
  v.choice(
      "planes", o.planes, {{"numbered", PlaneOrder::numbered}, {"in_order", PlaneOrder::in_order}});
  v.real("period_ms", o.period_s, 1e-3, 0, 60000);
  v.real("patience_s", o.patience_s, 1, 0.1, 3600);
}

/// Receives on a thread of its own, which waits while a volume that was received is not read: then
/// the server is slowed down, or leaves images out. Closed by the server: the end of the stream
/// between messages, else a loss.
class IgtlLink : public hw::Link {
 public:
  /// `server`: "HOST:PORT"; `geometry`: empty: the images' metadata say it. Waits for the first
  /// image. What is not taken is counted in `left_out`. Throws LinkOpenError, InvalidOption, and
  /// UserError for an image or a geometry that does not do.
  IgtlLink(const std::string& server,
           const std::filesystem::path& geometry,
           const IgtlLinkOptions& options,
           const std::shared_ptr<LeftOut>& left_out);
  ~IgtlLink() override;

  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime deadline) override;
  void cancel() override;
  void resume() override;
  void close() override;
  hw::LinkCapabilities capabilities() const override;
  std::string loss() const override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::bench
