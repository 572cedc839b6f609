// A link that injects faults into the packets of another link.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hw/link/faults.h"
#include "hw/link/link.h"

namespace wobblebench::hw {

enum class PacketKind : std::uint16_t;

/// An injected fault.
struct FaultEvent {
  FaultKind kind = FaultKind::drop;
  std::uint64_t packet = 0;  ///< index in the stream, all kinds counted from 0
  PacketKind packet_kind{};
  std::uint64_t sequence = 0;  ///< of the packet
};

/// Injects the faults of a plan. Which packets they affect depends on the plan's seed and the
/// packet's index only, not on the sizes of the reads. Damage of the inner link is passed on.
///
/// @code
/// #include "hw/recording/file_link.h"
/// auto file = std::make_unique<hw::FileLink>("scan.wbst");
/// hw::FaultLink link(std::move(file), hw::parse_faults("drop:0.01+unplug@5000+seed:7"));
/// std::vector<std::byte> buffer(65536);
/// while (link.read(buffer, hw::HostTime::max()).status == hw::ReadStatus::ok) {
/// }
/// for (const hw::FaultEvent& fault : link.events()) hw::to_string(fault.kind);
/// @endcode
class FaultLink : public Link {
 public:
  /// `time` must outlive this; null: the steady clock. Throws std::invalid_argument for a null
  /// link.
  FaultLink(std::unique_ptr<Link> inner, FaultPlan plan, const HostTimeSource* time = nullptr);
  ~FaultLink() override;

  ReadResult read(std::span<std::byte> buffer, HostTime deadline) override;
  void cancel() override;
  void resume() override;
  void close() override;
  LinkCapabilities capabilities() const override;
  std::optional<HostTime> epoch() const override;
  std::string loss() const override;

  /// The faults so far, in order. To be called by the reading thread.
  const std::vector<FaultEvent>& events() const;

 private:
  class Impl;

  const std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::hw
