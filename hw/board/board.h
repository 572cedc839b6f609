// The board: reads a link, decodes its packets, delivers sticks in order and counts every loss.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "base/options.h"
#include "hw/link/link.h"
#include "hw/probe/clock.h"
#include "hw/probe/polar_volume.h"
#include "hw/wire/account.h"
#include "hw/wire/configuration.h"

namespace wobblebench::hw {

class StickRing;

enum class ReaderMode {
  thread,   ///< the board reads on its own thread
  stepped,  ///< the caller of step() reads: for schedules that can be repeated
};

inline constexpr int kMaxRingSlots = 1 << 20;

struct BoardOptions {
  /// Sticks that are queued or held by the program, together. The default holds a volume of the
  /// paper's reference settings and two thirds of the next.
  int ring_slots = 4096;
  ReaderMode reader = ReaderMode::thread;
};

template <OptionsOf<BoardOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("ring_slots", o.ring_slots, 1, kMaxRingSlots);
}

/// Owns one slot of the ring, and releases it when destroyed. Stays readable after the board is
/// stopped, lost or destroyed. Movable; may be destroyed on any thread.
///
/// @code
/// #include "hw/recording/file_link.h"
/// hw::Board board(std::make_unique<hw::FileLink>("scan.wbst"));
/// board.start();
/// hw::Event event = board.next(hw::HostTime::max());
/// if (auto* slot = std::get_if<hw::StickSlot>(&event)) {
///   const hw::StickSlot held = std::move(*slot);
///   if (held->checked) held->samples.at(0);
/// }
/// @endcode
class StickSlot {
 public:
  StickSlot(std::shared_ptr<StickRing> ring, Stick* stick, HostTime received = {})
      : ring_(std::move(ring)), stick_(stick), received_(received) {}
  StickSlot(StickSlot&& other) noexcept
      : ring_(std::move(other.ring_)),
        stick_(std::exchange(other.stick_, nullptr)),
        received_(other.received_) {}
  StickSlot& operator=(StickSlot&& other) noexcept {
    std::swap(ring_, other.ring_);
    std::swap(stick_, other.stick_);
    std::swap(received_, other.received_);
    return *this;
  }
  ~StickSlot() {
    if (stick_ != nullptr) release();
  }

  const Stick& operator*() const { return *stick_; }
  const Stick* operator->() const { return stick_; }
  /// When the link's read() returned that brought the stick's last byte.
  HostTime received() const { return received_; }

 private:
  void release();

  std::shared_ptr<StickRing> ring_;
  Stick* stick_;
  HostTime received_;
};

struct VolumeEnd {
  std::uint32_t volume = 0;
  DeviceTime time{};
};

/// The link has no more bytes. `truncated`: it ended inside a packet or inside a volume.
struct EndOfStream {
  bool truncated = false;
};

enum class DeviceLossCause {
  unplugged,   ///< the link reports that the device is gone
  unreadable,  ///< the stream cannot be interpreted: its version, or its configuration
};

/// No more events until the board is closed and the link opened anew.
struct DeviceLost {
  DeviceLossCause cause = DeviceLossCause::unplugged;
  std::string reason;  ///< one line
};

struct TimedOut {};   ///< no event before the deadline
struct Cancelled {};  ///< cancel() was called
struct Stopped {};    ///< stop() was called, and all earlier events were taken

using Event = std::variant<Configuration,
                           StickSlot,
                           Gap,
                           VolumeEnd,
                           EndOfStream,
                           DeviceLost,
                           TimedOut,
                           Cancelled,
                           Stopped>;

/// A call that the board's state does not allow. The call changed nothing.
///
/// @code
/// #include "hw/recording/file_link.h"
/// hw::Board board(std::make_unique<hw::FileLink>("scan.wbst"));
/// try {
///   const hw::Event event = board.next(hw::HostTime::max());
/// } catch (const hw::IllegalBoardCall&) {
///   board.start();
/// }
/// @endcode
class IllegalBoardCall : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// open → running → stopping → configured (open, if no configuration came) → running …;
/// running → lost when the device is gone, until close(); any → closed, terminal.
enum class BoardState { open, configured, running, stopping, lost, closed };

/// One board over one link. Sticks are delivered in the order of their sequence numbers, each
/// once. Missing sticks are reported by a Gap at their position in the order.
///
/// A link that waits for its reader loses nothing to a full ring: the board waits too. From any
/// other link the board drops sticks that find no free slot, counts them, and reports the gap.
///
/// Threads: every function may be called from any thread. Threads that call next() share the
/// events; a single thread gets all of them in order. start(), stop() and close() wait for each
/// other. Destroying the board must not overlap with any call.
///
/// @code
/// #include "hw/recording/file_link.h"
/// hw::Board board(std::make_unique<hw::FileLink>("scan.wbst"), {.ring_slots = 8192});
/// board.start();
/// for (;;) {
///   const hw::Event event = board.next(hw::HostClock::now() + std::chrono::seconds(1));
///   if (const auto* slot = std::get_if<hw::StickSlot>(&event)) (*slot)->samples.at(0);
///   if (std::holds_alternative<hw::EndOfStream>(event)) break;
/// }
/// if (board.account().lost.total() > 0) throw std::runtime_error("sticks were lost");
/// @endcode
class Board {
 public:
  /// Takes an open link. Throws InvalidOption; std::invalid_argument for a null link.
  explicit Board(std::unique_ptr<Link> link, const BoardOptions& options = {});
  ~Board();
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  /// Starts reading, or continues after stop() or cancel(): what a link that does not wait lost
  /// meanwhile is reported as a gap. Throws IllegalBoardCall while running, lost or closed.
  void start();

  /// The next event, waiting until `deadline` at most; a deadline in the past polls. Returns at
  /// once where nothing can come: EndOfStream, DeviceLost, Cancelled and Stopped are returned again
  /// at every call. Throws IllegalBoardCall before the first start() and after close().
  [[nodiscard]] Event next(HostTime deadline);

  /// Stops reading and waits for the reader (10 ms if the link keeps its contract). Events before
  /// it can still be taken. May be repeated, in any state.
  void stop();

  /// Like stop(), without waiting; also, next() returns Cancelled at once, in all threads and at
  /// every call, until start(). No earlier event is lost. May be repeated.
  void cancel();

  /// Stops, and closes the link. Slots that are held stay readable. May be repeated.
  void close();

  /// With ReaderMode::stepped: enqueues what was read, and reads the link once without waiting.
  /// False if that had no effect: nothing to read, the queue full, or the stream over. Throws
  /// IllegalBoardCall with ReaderMode::thread, and unless running.
  bool step();

  BoardState state() const;
  /// Sticks in the queue count as delivered.
  BoardAccount account() const;
  WireDamage damage() const;
  LinkCapabilities capabilities() const;
  /// As Link::epoch().
  std::optional<HostTime> epoch() const;
  int ring_slots() const;
  int free_slots() const;

 private:
  class Impl;

  const std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::hw
