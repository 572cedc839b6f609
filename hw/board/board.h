// The board: reads a link, decodes its packets, keeps the ring, accounts for every loss.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "hw/board/ring.h"
#include "hw/link/link.h"
#include "hw/probe/clock.h"
#include "hw/probe/stick.h"
#include "hw/wire/account.h"
#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {

enum class ReaderMode {
  thread,   ///< the board reads on a thread of its own
  stepped,  ///< whoever calls step() reads: for a schedule that can be repeated
};

struct BoardOptions {
  /// Sticks that wait for the program, and sticks that the program holds, together. The default
  /// holds a volume of the paper's reference settings and two thirds of the next.
  int ring_slots = 4096;
  ReaderMode reader = ReaderMode::thread;
};

template <OptionsOf<BoardOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("ring_slots", o.ring_slots, 1, kMaxRingSlots);
}

/// Holds one slot of the ring, and gives it back when destroyed. Stays readable after the board
/// stopped, lost its device, or is gone. Movable; may be destroyed on any thread.
class StickSlot {
 public:
  StickSlot(std::shared_ptr<StickRing> ring, Stick* stick)
      : ring_(std::move(ring)), stick_(stick) {}
  StickSlot(StickSlot&& other) noexcept
      : ring_(std::move(other.ring_)), stick_(std::exchange(other.stick_, nullptr)) {}
  StickSlot& operator=(StickSlot&& other) noexcept {
    std::swap(ring_, other.ring_);
    std::swap(stick_, other.stick_);
    return *this;
  }
  ~StickSlot() {
    if (stick_ != nullptr) ring_->release(stick_);
  }

  const Stick& operator*() const { return *stick_; }
  const Stick* operator->() const { return stick_; }

 private:
  std::shared_ptr<StickRing> ring_;
  Stick* stick_;
};

struct VolumeEnd {
  std::uint32_t volume = 0;
  DeviceTime time{};
};

/// The link has no more. `truncated`: it ended inside a packet or inside a volume.
struct EndOfStream {
  bool truncated = false;
};

enum class LossOfDevice {
  unplugged,   ///< the link says that the device is gone
  unreadable,  ///< the stream cannot be interpreted: its version, or its configuration
};

/// Nothing will come until the board is closed and the link opened anew.
struct DeviceLost {
  LossOfDevice cause = LossOfDevice::unplugged;
  std::string reason;  ///< one line
};

struct TimedOut {};   ///< nothing came before the deadline
struct Cancelled {};  ///< cancel() was called
struct Stopped {};    ///< stop() was called, and all that had arrived was handed out

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
class IllegalBoardCall : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// open → running → stopping → configured (open, if no configuration came) → running …;
/// running → lost when the device is gone, until close(); any → closed, terminal.
enum class BoardState { open, configured, running, stopping, lost, closed };

/// One board over one link. Sticks are handed out in the order of their sequence numbers, each
/// once. Where some are missing, a Gap stands in their place, after every sound stick before it.
///
/// A link that waits for its reader loses nothing to a full ring: the board waits too. From any
/// other link the board drops what finds no free slot, counts it, and reports the gap.
///
/// Threads: every function may be called from any thread. Events are shared out among the threads
/// that call next(); one thread sees them all in order. start(), stop() and close() wait for each
/// other. Destroying the board must not overlap with any call.
class Board {
 public:
  /// Takes an open link. Throws InvalidOption; std::invalid_argument for a null link.
  explicit Board(std::unique_ptr<Link> link, const BoardOptions& options = {});
  ~Board();
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  /// Begins to read, or goes on where stop() or cancel() broke off: what a link that does not wait
  /// lost meanwhile shows as a gap. Throws IllegalBoardCall while running, lost or closed.
  void start();

  /// The next event, waiting until `deadline` at most; a deadline in the past polls. Never waits
  /// for what cannot come: EndOfStream, DeviceLost, Cancelled and Stopped are given again at every
  /// call. Throws IllegalBoardCall before the first start() and after close().
  Event next(HostTime deadline);

  /// Ends reading and waits for the reader (10 ms if the link keeps its word). What has arrived
  /// stays to be taken. May be repeated, in any state.
  void stop();

  /// Like stop(), without waiting; besides, next() gives Cancelled at once, in all threads and at
  /// every call, until start(). Nothing that has arrived is lost. May be repeated.
  void cancel();

  /// Stops, and closes the link. Slots that are held stay readable. May be repeated.
  void close();

  /// With ReaderMode::stepped: places what was read, and reads the link once without waiting. False
  /// if that brought nothing forward: the link was silent, the queue full, or the stream over.
  /// Throws IllegalBoardCall with a reader thread, and unless running.
  bool step();

  BoardState state() const;
  /// Sticks that wait to be taken count as delivered.
  BoardAccount account() const;
  WireDamage damage() const;
  LinkCapabilities capabilities() const { return link_->capabilities(); }
  int ring_slots() const { return ring_->slots(); }
  int free_slots() const { return ring_->free_slots(); }

 private:
  using Notice = std::variant<Configuration, StickSlot, Gap, VolumeEnd>;
  enum class Ending { none, end_of_stream, lost };

  // board.cpp: the program's side.
  void end_reader();
  void interrupt_reader();  ///< holding wake_
  void join_reader();
  std::optional<Event> ready_event();

  // board_intake.cpp: the reader thread. A bool is false where a stop broke off.
  void read_until(const std::stop_token& stop);
  bool read_link(const std::stop_token& stop, HostTime deadline);
  bool place_decoded(const std::stop_token& stop);
  bool place(const ConfigurationPacket& packet, const std::stop_token& stop);
  bool place(StickPacket& packet, const std::stop_token& stop);
  bool place(const VolumeEndPacket& packet, const std::stop_token& stop);
  std::optional<std::unique_lock<std::mutex>> lock_with_room(const std::stop_token& stop);
  Stick* wait_for_slot(const std::stop_token& stop);
  void note_damage();
  void announce();
  Ending ending() const;
  void end_stream();
  void lose_device(LossOfDevice cause, const std::string& reason);

  // The reader thread, holding mutex_.
  void report(const Audited& audited);
  void report(const Gap& gap);
  void push(Notice notice);
  bool queue_is_full() const;

  const std::unique_ptr<Link> link_;
  const bool waits_for_reader_;
  const ReaderMode reader_mode_;
  const std::shared_ptr<StickRing> ring_;

  // Locked in this order: control_, wake_, mutex_.
  std::mutex control_;     ///< held by start(), stop() and close() throughout
  std::thread reader_;     ///< guarded by control_
  std::mutex wake_;        ///< keeps a cancel() from falling between the steps of a start()
  std::stop_source stop_;  ///< guarded by wake_

  // Only the reader thread.
  std::vector<std::byte> incoming_;
  Decoder decoder_;
  std::optional<Packet> unplaced_;  ///< decoded, and waits for room
  bool cut_packet_ = false;
  WireDamage noted_damage_;   ///< as in damage_
  bool unannounced_ = false;  ///< something was placed since announce()
  bool stepped_on_ = false;   ///< the step under way read or placed something

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable_any changed_;
  BoardState state_ = BoardState::open;
  bool started_ = false;
  bool cancelled_ = false;
  StreamAudit audit_;
  WireDamage damage_;
  std::deque<Notice> queue_;
  std::optional<Gap> open_gap_;  ///< follows all that is queued; may still grow
  Ending ending_ = Ending::none;
  EndOfStream end_of_stream_;
  DeviceLost loss_;
};

}  // namespace wobblebench::hw
