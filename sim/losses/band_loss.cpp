#include "sim/losses/band_loss.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

BandLoss::BandLoss(const hw::ProbeOptions& probe) {
  const double sigma = probe.fractional_bandwidth / (2 * std::sqrt(2 * std::log(2.0)));
  variance_ = sigma * sigma;
  most_nepers_ = (1 - kLowest) / variance_;
}

double BandLoss::log_gain(double nepers) const {
  const double within = std::min(nepers, most_nepers_);
  return variance_ * within * (nepers - 0.5 * within);
}

double BandLoss::frequency_ratio(double nepers) const {
  return std::max(kLowest, 1 - nepers * variance_);
}

}  // namespace wobblebench::sim
