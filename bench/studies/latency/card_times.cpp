#include "bench/studies/latency/card_times.h"

#include <cmath>

#include "hw/wire/packet.h"
#include "sim/card/card_model.h"

namespace wobblebench::bench {

namespace {

double seconds(hw::DeviceTime time) {
  return 1e-9 * static_cast<double>(time.time_since_epoch().count());
}

/// Sends the packets of a volume, and reads the card at each of its interrupts.
class OneVolume {
 public:
  OneVolume(const hw::AcquisitionPlan& plan, const sim::CardOptions& options)
      : plan_(plan), card_(options), buffer_(1 << 16) {
    stick_.samples.resize(static_cast<std::size_t>(plan.acquisition().samples_per_stick));
  }

  std::vector<CardTimes> run() {
    send(hw::ConfigurationPacket{.source = hw::StreamOrigin::simulated,
                                 .probe = plan_.probe(),
                                 .acquisition = plan_.acquisition()},
         hw::DeviceTime{});
    for (int stick = 0; stick < plan_.sticks_per_volume(); ++stick) {
      send(stick_, end_of(stick));
      times_.push_back({seconds(card_.transfer_end()), 0});
      ends_.push_back(sent_);
    }
    send(hw::VolumeEndPacket{}, end_of(plan_.sticks_per_volume() - 1), /*ends_volume=*/true);
    read_until(hw::DeviceTime::max());
    return std::move(times_);
  }

 private:
  hw::DeviceTime end_of(int stick) const {
    return hw::DeviceTime(
        hw::DeviceDuration(std::llround((stick + 1) * plan_.stick_period_s() * 1e9)));
  }

  template <class Sent>
  void send(const Sent& packet, hw::DeviceTime at, bool ends_volume = false) {
    read_until(at);
    packet_.clear();
    hw::encode(packet, packet_);
    sent_ += packet_.size();
    card_.push(packet_, at, ends_volume);
  }

  void read_until(hw::DeviceTime until) {
    while (const auto interrupt = card_.next_interrupt()) {
      if (*interrupt > until) return;
      read_ += card_.read(buffer_, *interrupt);
      for (; announced_ < ends_.size() && ends_[announced_] <= read_; ++announced_) {
        times_[announced_].interrupt_s = seconds(*interrupt);
      }
    }
  }

  const hw::AcquisitionPlan& plan_;
  sim::CardModel card_;
  hw::Stick stick_;
  std::vector<std::byte> buffer_, packet_;
  std::vector<CardTimes> times_;
  std::vector<std::size_t> ends_;  ///< bytes sent up to the end of each stick's packet
  std::size_t sent_ = 0, read_ = 0, announced_ = 0;
};

}  // namespace

std::vector<CardTimes> card_times(const hw::AcquisitionPlan& plan, const sim::CardOptions& card) {
  return OneVolume(plan, card).run();
}

CardDelays card_delays(const hw::AcquisitionPlan& plan, const sim::CardOptions& card) {
  const auto times = card_times(plan, card);
  const double last_s = (plan.sticks_per_volume() - 1) * plan.stick_period_s();
  const auto after = [](const CardTimes& of, double fired_s) {
    return CardDelay{1e3 * (of.dma_complete_s - fired_s), 1e3 * (of.interrupt_s - fired_s)};
  };
  return {after(times.front(), 0), after(times.back(), last_s)};
}

}  // namespace wobblebench::bench
