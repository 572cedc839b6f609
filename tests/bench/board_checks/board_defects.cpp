// Defects of the board, each made by replacing functions of a correct one.
#include <atomic>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "tests/bench/board_checks/defects.h"

namespace wobblebench::bench {

namespace {

using std::chrono::milliseconds;
using Next = std::function<hw::Event(hw::HostTime)>;
/// Replaces functions of the board by defective ones.
using Break = std::function<void(BoardInterface& board)>;

Defect make_defect(const std::string& check,
                   const std::string& what,
                   const Break& with,
                   const std::string& arguments = "") {
  Defect defect{check, what, correct_fixture(arguments)};
  defect.fixture.interface = [with](hw::Board& board_under_test) {
    BoardInterface board = interface_of(board_under_test);
    with(board);
    return board;
  };
  return defect;
}

/// Changes what next() returns.
Break with_next(const std::function<hw::Event(const Next&, hw::HostTime)>& changed) {
  return [changed](BoardInterface& board) {
    board.next = [next = board.next, changed](hw::HostTime deadline) {
      return changed(next, deadline);
    };
  };
}

/// Skips events for which `unwanted` holds.
Break without(const std::function<bool(const hw::Event&)>& unwanted) {
  return with_next([unwanted](const Next& next, hw::HostTime deadline) {
    for (;;) {
      hw::Event event = next(deadline);
      if (!unwanted(event)) return event;
    }
  });
}

/// Changes each stick returned; `count`: of those before it.
Break with_sticks(const std::function<void(hw::Stick& stick, int count)>& change) {
  return [change](BoardInterface& board) {
    auto count = std::make_shared<std::atomic<int>>(0);
    board.next = [next = board.next, change, count](hw::HostTime deadline) {
      hw::Event event = next(deadline);
      if (auto* slot = std::get_if<hw::StickSlot>(&event)) {
        // The defect: a board must not change what it has handed out.
        change(const_cast<hw::Stick&>(**slot), (*count)++);
      }
      return event;
    };
  };
}

template <class Kind>
bool is(const hw::Event& event) {
  return std::holds_alternative<Kind>(event);
}

/// Drops the first stick after each start but the first.
void lose_one_at_restart(BoardInterface& board) {
  auto starts = std::make_shared<int>(0);
  auto drop = std::make_shared<bool>(false);
  board.start = [start = board.start, starts, drop] {
    start();
    *drop = (*starts)++ > 0;
  };
  board.next = [next = board.next, drop](hw::HostTime deadline) {
    hw::Event event = next(deadline);
    if (!*drop || !is<hw::StickSlot>(event)) return event;
    *drop = false;
    return next(deadline);
  };
}

/// At the 50th stick writes into the first.
void write_held_slots(BoardInterface& board) {
  auto sticks = std::make_shared<std::vector<hw::Stick*>>();
  board.next = [next = board.next, sticks](hw::HostTime deadline) {
    hw::Event event = next(deadline);
    if (auto* slot = std::get_if<hw::StickSlot>(&event)) {
      sticks->push_back(const_cast<hw::Stick*>(&**slot));
      if (sticks->size() == 50) sticks->front()->samples.front() += 1;
    }
    return event;
  };
}

void clear_slots_at_close(BoardInterface& board) {
  auto sticks = std::make_shared<std::vector<hw::Stick*>>();
  board.next = [next = board.next, sticks](hw::HostTime deadline) {
    hw::Event event = next(deadline);
    if (auto* slot = std::get_if<hw::StickSlot>(&event)) {
      sticks->push_back(const_cast<hw::Stick*>(&**slot));
    }
    return event;
  };
  board.close = [close = board.close, sticks] {
    close();
    for (hw::Stick* stick : *sticks) stick->samples.front() += 1;
  };
}

/// Reports the device as lost once `fatal` holds for the account.
Break lost_if(const std::function<bool(const hw::BoardAccount&)>& fatal) {
  return [fatal](BoardInterface& board) {
    board.next = [next = board.next, account = board.account, fatal](hw::HostTime deadline) {
      if (fatal(account()))
        return hw::Event(hw::DeviceLost{hw::DeviceLossCause::unplugged, "gave up"});
      return next(deadline);
    };
  };
}

/// Reports the loss once, then times out.
void forget_the_loss(BoardInterface& board) {
  auto reported = std::make_shared<bool>(false);
  board.next = [next = board.next, reported](hw::HostTime deadline) {
    if (*reported) return hw::Event(hw::TimedOut{});
    hw::Event event = next(deadline);
    *reported = is<hw::DeviceLost>(event);
    return event;
  };
}

std::vector<Defect> state_defects() {
  return {
      make_defect("states.before_start",
                  "next() before start() times out",
                  [](BoardInterface& board) {
                    board.next = [next = board.next, state = board.state](hw::HostTime deadline) {
                      if (state() == hw::BoardState::open) return hw::Event(hw::TimedOut{});
                      return next(deadline);
                    };
                  }),
      make_defect("states.start_twice",
                  "start() while running is ignored",
                  [](BoardInterface& board) {
                    board.start = [start = board.start, state = board.state] {
                      if (state() != hw::BoardState::running) start();
                    };
                  }),
      make_defect("states.stop_twice",
                  "a second stop() throws",
                  [](BoardInterface& board) {
                    board.stop = [stop = board.stop, stopped = std::make_shared<bool>(false)] {
                      if (std::exchange(*stopped, true)) throw hw::IllegalBoardCall("not running");
                      stop();
                    };
                  }),
      make_defect("states.after_close",
                  "a closed board calls itself open",
                  [](BoardInterface& board) {
                    board.state = [state = board.state] {
                      const hw::BoardState real = state();
                      return real == hw::BoardState::closed ? hw::BoardState::open : real;
                    };
                  }),
      make_defect("states.restart", "a restart loses a stick in silence", lose_one_at_restart),
      make_defect("threads.shared",
                  "every tenth stick is given twice",
                  with_sticks([](hw::Stick& stick, int count) {
                    if (count % 10 == 9) --stick.sequence;
                  })),
  };
}

std::vector<Defect> slot_and_account_defects() {
  return {
      make_defect("slots.held", "the board writes a slot that is held", write_held_slots),
      make_defect("slots.outlive", "close() takes held slots back", clear_slots_at_close),
      make_defect("slots.credit",
                  "a slot is free as soon as it is handed out",
                  [](BoardInterface& board) { board.free_slots = [] { return 16; }; }),
      make_defect("account.balanced",
                  "one stick more is delivered than emitted",
                  [](BoardInterface& board) {
                    board.account = [account = board.account] {
                      hw::BoardAccount changed = account();
                      ++changed.delivered;
                      return changed;
                    };
                  }),
      make_defect(
          "account.seamless", "gaps are not reported", without(is<hw::Gap>), ",faults=drop:0.1"),
      make_defect(
          "account.overrun",
          "a full ring ends the stream",
          lost_if([](const hw::BoardAccount& account) { return account.lost.ring_full > 0; }),
          ",pace=realtime"),
      make_defect(
          "errors.damage",
          "a damaged packet ends the stream",
          lost_if([](const hw::BoardAccount& account) { return account.lost.corrupt > 0; })),
  };
}

std::vector<Defect> stream_defects() {
  return {
      make_defect(
          "stream.configured", "the configuration is kept back", without(is<hw::Configuration>)),
      make_defect("stream.plan",
                  "a stick stands on another line",
                  with_sticks([](hw::Stick& stick, int) { stick.index.line ^= 1; })),
      make_defect("stream.times", "time stands still", with_sticks([](hw::Stick& stick, int) {
                    stick.time = {};
                  })),
      make_defect("stream.volume_end", "volume ends are kept back", without(is<hw::VolumeEnd>)),
      make_defect("stream.stale",
                  "a stick holds the samples of the one before",
                  with_sticks([before = std::make_shared<std::vector<float>>()](hw::Stick& stick,
                                                                                int count) {
                    if (count % 8 == 7) stick.samples = *before;
                    *before = stick.samples;
                  })),
      make_defect("stream.same",
                  "samples differ from opening to opening",
                  with_sticks([calls = std::make_shared<int>(0)](hw::Stick& stick, int) {
                    stick.samples.front() = static_cast<float>((*calls)++);
                  })),
  };
}

std::vector<Defect> wait_defects() {
  return {
      make_defect("timeout.poll",
                  "a poll sleeps for 20 ms",
                  with_next([](const Next& next, hw::HostTime deadline) {
                    if (deadline == hw::HostTime::min())
                      std::this_thread::sleep_for(milliseconds(20));
                    return next(deadline);
                  })),
      make_defect("timeout.pending",
                  "a poll never finds anything",
                  with_next([](const Next& next, hw::HostTime deadline) {
                    if (deadline == hw::HostTime::min()) return hw::Event(hw::TimedOut{});
                    return next(deadline);
                  })),
      make_defect("timeout.deadline",
                  "it waits a quarter of a second longer",
                  with_next([](const Next& next, hw::HostTime deadline) {
                    return next(deadline + milliseconds(250));
                  })),
      make_defect("cancel.wakes",
                  "cancel() takes effect after 50 ms",
                  [](BoardInterface& board) {
                    board.cancel = [cancel = board.cancel] {
                      std::this_thread::sleep_for(milliseconds(50));
                      cancel();
                    };
                  }),
      make_defect(
          "cancel.restart", "a stick is lost in silence after cancel()", lose_one_at_restart),
      make_defect("unplug.told", "a lost device looks like a silent one", forget_the_loss),
  };
}

}  // namespace

std::vector<Defect> board_defects() {
  std::vector<Defect> all;
  for (auto part :
       {state_defects(), slot_and_account_defects(), stream_defects(), wait_defects()}) {
    std::move(part.begin(), part.end(), std::back_inserter(all));
  }
  return all;
}

}  // namespace wobblebench::bench
