#include "sim/losses/place_sums.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

LateralSum::LateralSum(const ApertureCone& cone, const BeamPlaces& places, const LossGrid& grid)
    : cone_(cone),
      places_(places),
      grid_(grid),
      margin_(places.most_lines() + 2),
      rows_(static_cast<std::size_t>(kRows) * static_cast<std::size_t>(grid.lines + 2 * margin_)) {
  const auto lines = static_cast<std::size_t>(grid.lines);
  shares_.resize(lines);
  for (auto& weights : weights_) weights.resize(lines);
  sums_.resize(lines * 2 * ApertureCone::kEnds);
  power_.resize(lines);
}

const double* LateralSum::power(int node, const Reaching& reaching) {
  std::copy_n(reaching.amplitude, grid_.lines, row(kWays) + margin_);
  std::copy_n(reaching.material, grid_.lines, row(kWays + 1) + margin_);
  for (int number = 0; number < kRows; ++number) extend(number);
  std::ranges::fill(power_, 0.0);
  for (int place = 0; place < BeamPlaces::kPlaces; ++place) {
    weigh(places_.lines_aside(node, place), reaching);
    for (int end = 0; end < ApertureCone::kEnds; ++end) sum_waves(end, node, place);
    add_power(sum(0), sum(1), grid_.lines, power_.data());
  }
  const double* free = places_.lateral_power(node);
  for (std::size_t line = 0; line < power_.size(); ++line) power_[line] /= free[line];
  return power_.data();
}

void LateralSum::extend(int number) {
  float* first = row(number) + margin_;
  std::fill_n(row(number), margin_, *first);
  std::fill_n(first + grid_.lines, margin_, first[grid_.lines - 1]);
}

void LateralSum::weigh(float aside, const Reaching& reaching) {
  const float whole = std::floor(aside);
  std::ranges::fill(weights_[2], 1.0f);
  for (int i = 0; i < 2; ++i) {
    const int lines = margin_ + static_cast<int>(whole) + i;
    std::ranges::fill(shares_, i == 0 ? 1 - (aside - whole) : aside - whole);
    weigh_beside({row(kWays) + lines, row(kWays + 1) + lines},
                 reaching,
                 shares_.data(),
                 grid_.lines,
                 weights_[i].data(),
                 weights_[2].data());
  }
}

WaveRow LateralSum::sum(int end) {
  double* real = sums_.data() + static_cast<std::ptrdiff_t>(2 * end * grid_.lines);
  return {real, real + grid_.lines};
}

void LateralSum::sum_waves(int end, int node, int place) {
  const WaveRow to = sum(end);
  std::fill_n(to.real, 2 * grid_.lines, 0.0);
  const int before = static_cast<int>(std::floor(places_.lines_aside(node, place)));
  for (int part = 0; part < ApertureCone::kLateral; ++part) {
    const float* own = ways(end, part);
    add_wave({own + before, own + before + 1, own},
             {weights_[0].data(), weights_[1].data(), weights_[2].data()},
             cone_.on_array(end, part, node),
             places_.lateral(end, node, place)[part],
             grid_.lines,
             to);
  }
}

ElevationSum::ElevationSum(const BeamPlaces& places, const LossGrid& grid, const LossTable& table)
    : places_(places), grid_(grid), table_(table) {
  const auto lines = static_cast<std::size_t>(grid.lines);
  before_.resize(lines);
  for (auto& shares : shares_) shares.resize(lines);
  for (auto& weights : weights_) weights.resize(lines);
  whole_.assign(lines, 1.0f);
  sums_.resize(2 * lines);
  power_.resize(lines);
}

const double* ElevationSum::power_over_mean(int frame, int node, const float* parts) {
  std::ranges::fill(power_, 0.0);
  const WaveRow wave{sums_.data(), sums_.data() + grid_.lines};
  for (int place = 0; place < BeamPlaces::kPlaces; ++place) {
    weigh(frame, node, place);
    sum_waves(frame, node, place, parts);
    add_power(wave, wave, grid_.lines, power_.data());
  }
  const float* own = parts + row(frame, node, 0);
  const double free = places_.elevation_power(node);
  for (int line = 0; line < grid_.lines; ++line) {
    double mean = 0;
    for (int part = 0; part < ApertureCone::kElevation; ++part) {
      const auto at = row(0, 0, part) + line;
      mean += static_cast<double>(own[at]) / ApertureCone::kElevation;
    }
    power_[static_cast<std::size_t>(line)] /= free * mean * mean * mean * mean;
  }
  return power_.data();
}

/// Neighbouring lines mostly have the same frame before them, and are treated together.
template <class Run>
void ElevationSum::for_runs(Run run) const {
  for (int first = 0, end = 0; first < grid_.lines; first = end) {
    const std::int32_t before = before_[static_cast<std::size_t>(first)];
    while (end < grid_.lines && before_[static_cast<std::size_t>(end)] == before) ++end;
    run(first, end - first, before);
  }
}

void ElevationSum::weigh(int frame, int node, int place) {
  locate_frames(frame,
                grid_.frames,
                places_.across_m(node, place),
                places_.frames_per_m(node),
                grid_.lines,
                before_.data(),
                shares_[1].data());
  std::ranges::transform(shares_[1], shares_[0].begin(), [](float share) { return 1 - share; });
  const auto reaching = [&](int of_frame, int line) {
    const auto at = static_cast<std::ptrdiff_t>(of_frame) * grid_.lines + line;
    return Reaching{table_.transmitted(node - 1) + at, table_.material(node) + at};
  };
  std::ranges::fill(weights_[2], 1.0f);
  for_runs([&](int first, int count, int before) {
    for (int i = 0; i < 2; ++i) {
      weigh_beside(reaching(before + i, first),
                   reaching(frame, first),
                   shares_[i].data() + first,
                   count,
                   weights_[i].data() + first,
                   weights_[2].data() + first);
    }
  });
}

void ElevationSum::sum_waves(int frame, int node, int place, const float* parts) {
  std::ranges::fill(sums_, 0.0);
  for_runs([&](int first, int count, int before) {
    for (int part = 0; part < ApertureCone::kElevation; ++part) {
      const float* at = parts + first;
      add_wave({at + row(before, node, part),
                at + row(before + 1, node, part),
                at + row(frame, node, part)},
               {weights_[0].data() + first, weights_[1].data() + first, weights_[2].data() + first},
               whole_.data(),
               places_.elevation(node, place)[part],
               count,
               {sums_.data() + first, sums_.data() + grid_.lines + first});
    }
  });
}

}  // namespace wobblebench::sim
