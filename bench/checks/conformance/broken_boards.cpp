#include <atomic>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "bench/checks/conformance/broken.h"

namespace wobblebench::bench {

namespace {

using std::chrono::milliseconds;
using Next = std::function<hw::Event(hw::HostTime)>;
using Break = std::function<void(BoardFace& face)>;

Breakage broken(const std::string& check,
                const std::string& what,
                const Break& with,
                const std::string& board = "") {
  Breakage breakage{check, what, sound_fixture(board)};
  breakage.fixture.face = [with](hw::Board& board_under_test) {
    BoardFace face = face_of(board_under_test);
    with(face);
    return face;
  };
  return breakage;
}

/// Changes what next() gives.
Break with_next(const std::function<hw::Event(const Next&, hw::HostTime)>& changed) {
  return [changed](BoardFace& face) {
    face.next = [next = face.next, changed](hw::HostTime deadline) {
      return changed(next, deadline);
    };
  };
}

/// Leaves out events for which `unwanted` holds.
Break without(const std::function<bool(const hw::Event&)>& unwanted) {
  return with_next([unwanted](const Next& next, hw::HostTime deadline) {
    for (;;) {
      hw::Event event = next(deadline);
      if (!unwanted(event)) return event;
    }
  });
}

/// Changes each stick that is handed out; `count` counts them from 0.
Break with_sticks(const std::function<void(hw::Stick& stick, int count)>& change) {
  return [change](BoardFace& face) {
    auto count = std::make_shared<std::atomic<int>>(0);
    face.next = [next = face.next, change, count](hw::HostTime deadline) {
      hw::Event event = next(deadline);
      if (auto* slot = std::get_if<hw::StickSlot>(&event)) {
        // A board may not do this; that is the point.
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
void lose_one_at_restart(BoardFace& face) {
  auto starts = std::make_shared<int>(0);
  auto drop = std::make_shared<bool>(false);
  face.start = [start = face.start, starts, drop] {
    start();
    *drop = (*starts)++ > 0;
  };
  face.next = [next = face.next, drop](hw::HostTime deadline) {
    hw::Event event = next(deadline);
    if (!*drop || !is<hw::StickSlot>(event)) return event;
    *drop = false;
    return next(deadline);
  };
}

/// Writes into the stick handed out three calls before.
void write_held_slots(BoardFace& face) {
  auto given = std::make_shared<std::vector<hw::Stick*>>();
  face.next = [next = face.next, given](hw::HostTime deadline) {
    hw::Event event = next(deadline);
    if (auto* slot = std::get_if<hw::StickSlot>(&event)) {
      given->push_back(const_cast<hw::Stick*>(&**slot));
      if (given->size() == 50) given->front()->samples.front() += 1;
    }
    return event;
  };
}

void clear_slots_at_close(BoardFace& face) {
  auto given = std::make_shared<std::vector<hw::Stick*>>();
  face.next = [next = face.next, given](hw::HostTime deadline) {
    hw::Event event = next(deadline);
    if (auto* slot = std::get_if<hw::StickSlot>(&event)) {
      given->push_back(const_cast<hw::Stick*>(&**slot));
    }
    return event;
  };
  face.close = [close = face.close, given] {
    close();
    for (hw::Stick* stick : *given) stick->samples.front() += 1;
  };
}

/// Says that the device is lost as soon as `fatal` holds of the account.
Break lost_if(const std::function<bool(const hw::BoardAccount&)>& fatal) {
  return [fatal](BoardFace& face) {
    face.next = [next = face.next, account = face.account, fatal](hw::HostTime deadline) {
      if (fatal(account()))
        return hw::Event(hw::DeviceLost{hw::DeviceLossCause::unplugged, "gave up"});
      return next(deadline);
    };
  };
}

void forget_the_loss(BoardFace& face) {
  auto told = std::make_shared<bool>(false);
  face.next = [next = face.next, told](hw::HostTime deadline) {
    if (*told) return hw::Event(hw::TimedOut{});
    hw::Event event = next(deadline);
    *told = is<hw::DeviceLost>(event);
    return event;
  };
}

std::vector<Breakage> broken_states() {
  return {
      broken("states.before_start",
             "next() before start() times out",
             [](BoardFace& face) {
               face.next = [next = face.next, state = face.state](hw::HostTime deadline) {
                 if (state() == hw::BoardState::open) return hw::Event(hw::TimedOut{});
                 return next(deadline);
               };
             }),
      broken("states.start_twice",
             "start() while running is ignored",
             [](BoardFace& face) {
               face.start = [start = face.start, state = face.state] {
                 if (state() != hw::BoardState::running) start();
               };
             }),
      broken("states.stop_twice",
             "a second stop() throws",
             [](BoardFace& face) {
               face.stop = [stop = face.stop, stopped = std::make_shared<bool>(false)] {
                 if (std::exchange(*stopped, true)) throw hw::IllegalBoardCall("not running");
                 stop();
               };
             }),
      broken("states.after_close",
             "a closed board calls itself open",
             [](BoardFace& face) {
               face.state = [state = face.state] {
                 const hw::BoardState real = state();
                 return real == hw::BoardState::closed ? hw::BoardState::open : real;
               };
             }),
      broken("states.restart", "a restart loses a stick in silence", lose_one_at_restart),
      broken("threads.shared",
             "every tenth stick is given twice",
             with_sticks([](hw::Stick& stick, int count) {
               if (count % 10 == 9) --stick.sequence;
             })),
  };
}

std::vector<Breakage> broken_slots_and_accounts() {
  return {
      broken("slots.held", "the board writes a slot that is held", write_held_slots),
      broken("slots.outlive", "close() takes held slots back", clear_slots_at_close),
      broken("slots.credit",
             "a slot is free as soon as it is handed out",
             [](BoardFace& face) { face.free_slots = [] { return 16; }; }),
      broken("account.balanced",
             "one stick more is delivered than emitted",
             [](BoardFace& face) {
               face.account = [account = face.account] {
                 hw::BoardAccount changed = account();
                 ++changed.delivered;
                 return changed;
               };
             }),
      broken("account.seamless", "gaps are not reported", without(is<hw::Gap>), ",faults=drop:0.1"),
      broken("account.overrun",
             "a full ring ends the stream",
             lost_if([](const hw::BoardAccount& account) { return account.lost.ring_full > 0; }),
             ",pace=realtime"),
      broken("errors.damage",
             "a damaged packet ends the stream",
             lost_if([](const hw::BoardAccount& account) { return account.lost.corrupt > 0; })),
  };
}

std::vector<Breakage> broken_streams() {
  return {
      broken("stream.configured", "the configuration is kept back", without(is<hw::Configuration>)),
      broken("stream.plan",
             "a stick stands on another line",
             with_sticks([](hw::Stick& stick, int) { stick.index.line ^= 1; })),
      broken("stream.times", "time stands still", with_sticks([](hw::Stick& stick, int) {
               stick.time = {};
             })),
      broken("stream.volume_end", "volume ends are kept back", without(is<hw::VolumeEnd>)),
      broken("stream.stale",
             "a stick holds the samples of the one before",
             with_sticks(
                 [before = std::make_shared<std::vector<float>>()](hw::Stick& stick, int count) {
                   if (count % 8 == 7) stick.samples = *before;
                   *before = stick.samples;
                 })),
      broken("stream.same",
             "samples differ from opening to opening",
             with_sticks([calls = std::make_shared<int>(0)](hw::Stick& stick, int) {
               stick.samples.front() = static_cast<float>((*calls)++);
             })),
  };
}

std::vector<Breakage> broken_waits() {
  std::vector<Breakage> waits = {
      broken("timeout.poll",
             "a poll sleeps for 20 ms",
             with_next([](const Next& next, hw::HostTime deadline) {
               if (deadline == hw::HostTime::min()) std::this_thread::sleep_for(milliseconds(20));
               return next(deadline);
             })),
      broken("timeout.pending",
             "a poll never finds anything",
             with_next([](const Next& next, hw::HostTime deadline) {
               if (deadline == hw::HostTime::min()) return hw::Event(hw::TimedOut{});
               return next(deadline);
             })),
      broken("timeout.deadline",
             "it waits a quarter of a second longer",
             with_next([](const Next& next, hw::HostTime deadline) {
               return next(deadline + milliseconds(250));
             })),
      broken("cancel.wakes",
             "cancel() takes effect after 50 ms",
             [](BoardFace& face) {
               face.cancel = [cancel = face.cancel] {
                 std::this_thread::sleep_for(milliseconds(50));
                 cancel();
               };
             }),
      broken("cancel.restart", "a stick is lost in silence after cancel()", lose_one_at_restart),
      broken("unplug.told", "a lost device looks like a silent one", forget_the_loss),
  };
  return waits;
}

}  // namespace

std::vector<Breakage> broken_boards() {
  std::vector<Breakage> all;
  for (auto part :
       {broken_states(), broken_slots_and_accounts(), broken_streams(), broken_waits()}) {
    std::move(part.begin(), part.end(), std::back_inserter(all));
  }
  return all;
}

}  // namespace wobblebench::bench
