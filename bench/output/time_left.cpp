#include "bench/output/time_left.h"

#include <algorithm>

namespace wobblebench::bench {

void TimeLeft::begin(const std::string& step, double now_s) {
  if (plan_.empty()) {
    start_s_ = now_s;
    done_share_ = 0;
    return;
  }
  before_ = done_share_;
  const auto here = std::find_if(
      plan_.begin(), plan_.end(), [&](const PlannedStep& one) { return one.name == step; });
  share_ = here == plan_.end() ? 0 : here->share;
  if (here == plan_.end()) return;
  after_ = 0;
  for (auto next = here + 1; next != plan_.end(); ++next) after_ += next->share;
  left_share_ = share_ + after_;
}

void TimeLeft::part(double fraction, double now_s) {
  done_share_ = before_ + fraction * share_;
  left_share_ = (1 - fraction) * share_ + after_;
  part_s_ = now_s;
}

std::optional<double> TimeLeft::seconds(double now_s) const {
  if (done_share_ <= 0) return {};
  const double left = (part_s_ - start_s_) / done_share_ * left_share_ - (now_s - part_s_);
  if (left < 0) return {};
  return left;
}

}  // namespace wobblebench::bench
