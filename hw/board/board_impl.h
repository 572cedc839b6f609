// State and threads of a board.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "hw/board/board.h"
#include "hw/board/ring.h"
#include "hw/wire/decoder.h"
#include "hw/wire/packet.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {

/// The functions are those of Board.
class Board::Impl {
 public:
  Impl(std::unique_ptr<Link> link, const BoardOptions& options);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void start();
  Event next(HostTime deadline);
  void stop();
  void cancel();
  void close();
  bool step();

  BoardState state() const;
  BoardAccount account() const;
  WireDamage damage() const;
  LinkCapabilities capabilities() const { return link_->capabilities(); }
  std::optional<HostTime> epoch() const { return link_->epoch(); }
  int ring_slots() const { return ring_->slots(); }
  int free_slots() const { return ring_->free_slots(); }

 private:
  /// Events that wait in the queue.
  using QueuedEvent = std::variant<Configuration, StickSlot, Gap, VolumeEnd>;
  enum class Ending { none, end_of_stream, lost };

  // board.cpp: the program's side.
  void end_reader();
  void interrupt_reader();  ///< holding wake_
  void join_reader();
  std::optional<Event> ready_event();

  // board_reader.cpp: the reader thread. A bool is false where a stop interrupted it.
  void read_until(const std::stop_token& stop);
  bool read_link(const std::stop_token& stop, HostTime deadline);
  bool enqueue_decoded(const std::stop_token& stop);
  bool enqueue(const ConfigurationPacket& packet, const std::stop_token& stop);
  bool enqueue(StickPacket& packet, const std::stop_token& stop);
  bool enqueue(const VolumeEndPacket& packet, const std::stop_token& stop);
  std::optional<std::unique_lock<std::mutex>> lock_with_room(const std::stop_token& stop);
  Stick* wait_for_slot(const std::stop_token& stop);
  void update_damage();
  void notify_program();
  Ending ending() const;
  void end_stream();
  void lose_device(DeviceLossCause cause, const std::string& reason);

  // The reader thread, holding mutex_.
  void report(const AuditResult& result);
  void report(const Gap& gap);
  void push(QueuedEvent event);
  bool queue_is_full() const;

  const std::unique_ptr<Link> link_;
  const bool waits_for_reader_;
  const ReaderMode reader_mode_;
  const std::shared_ptr<StickRing> ring_;

  // Locked in this order: control_, wake_, mutex_.
  std::mutex control_;     ///< held by start(), stop() and close() throughout
  std::jthread reader_;    ///< guarded by control_
  std::mutex wake_;        ///< serialises cancel() with start()
  std::stop_source stop_;  ///< guarded by wake_

  // Used by the reader thread only.
  std::vector<std::byte> incoming_;
  Decoder decoder_;
  std::optional<Packet> pending_;  ///< decoded, not yet enqueued
  HostTime received_{};            ///< the end of the last read that brought bytes
  bool packet_was_cut_ = false;    ///< by the end of the stream
  WireDamage known_damage_;        ///< as in damage_
  bool unnotified_ = false;        ///< an event was enqueued since notify_program()
  bool progressed_ = false;        ///< the current step read or enqueued something

  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable_any changed_;
  BoardState state_ = BoardState::open;
  bool started_ = false;
  bool cancelled_ = false;
  StreamAudit audit_;
  WireDamage damage_;
  std::deque<QueuedEvent> queue_;
  std::optional<Gap> open_gap_;  ///< follows the queued events; may still grow
  Ending ending_ = Ending::none;
  EndOfStream end_of_stream_;
  DeviceLost loss_;
};

}  // namespace wobblebench::hw
