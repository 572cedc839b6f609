#include "sim/losses/section_sums.h"

#include <algorithm>
#include <cmath>

#include "sim/math/fast_math.h"

namespace wobblebench::sim {

namespace {

/// Values of the two sticks beside a sample point and of the stick itself, for each line.
struct PointRows {
  const float* first;
  const float* second;
  const float* own;
};

/// Weight of a neighbouring stick at a sample point, of which it has the fraction `share`: own[i],
/// the stick's own weight, decreases by weight[i]. It is 0 for a neighbour in another material.
WOBBLEBENCH_SIMD void weigh_beside(const float* __restrict material,
                                   const float* __restrict own_material,
                                   const float* __restrict share,
                                   int count,
                                   float* __restrict weight,
                                   float* __restrict own) {
  for (int i = 0; i < count; ++i) {
    weight[i] = material[i] == own_material[i] ? share[i] : 0.0f;
    own[i] -= weight[i];
  }
}

/// weight[i] *= amplitude[i] / own_amplitude[i].
WOBBLEBENCH_SIMD void scale_to_axis(const float* __restrict amplitude,
                                    const float* __restrict own_amplitude,
                                    int count,
                                    float* __restrict weight) {
  for (int i = 0; i < count; ++i) weight[i] *= amplitude[i] / own_amplitude[i];
}

/// Adds wave * part[i] * the weighted sum of the rows' amplitudes. `part`: fraction of the
/// aperture's part that lies on the array.
WOBBLEBENCH_SIMD void add_wave(const PointRows& amplitude,
                               const PointRows& weight,
                               const float* __restrict part,
                               std::complex<double> wave,
                               int count,
                               WaveRow sum) {
  const double re = wave.real(), im = wave.imag();
  const float* __restrict first = amplitude.first;
  const float* __restrict second = amplitude.second;
  const float* __restrict own = amplitude.own;
  const float* __restrict of_first = weight.first;
  const float* __restrict of_second = weight.second;
  const float* __restrict of_own = weight.own;
  double* __restrict real = sum.real;
  double* __restrict imaginary = sum.imaginary;
  for (int i = 0; i < count; ++i) {
    const float there = of_first[i] * first[i] + of_second[i] * second[i] + of_own[i] * own[i];
    const double each = static_cast<double>(part[i] * there);
    real[i] += re * each;
    imaginary[i] += im * each;
  }
}

/// power[i] += |transmit[i]|^2 |receive[i]|^2.
WOBBLEBENCH_SIMD void add_power(WaveRow transmit,
                                WaveRow receive,
                                int count,
                                double* __restrict power) {
  for (int i = 0; i < count; ++i) {
    const double sent =
        transmit.real[i] * transmit.real[i] + transmit.imaginary[i] * transmit.imaginary[i];
    const double received =
        receive.real[i] * receive.real[i] + receive.imaginary[i] * receive.imaginary[i];
    power[i] += sent * received;
  }
}

}  // namespace

WOBBLEBENCH_SIMD void locate_frames(int frame,
                                    int frames,
                                    float aside_m,
                                    const float* __restrict frames_per_m,
                                    int lines,
                                    std::int32_t* __restrict before,
                                    float* __restrict share) {
  const auto here = static_cast<float>(frame), last = static_cast<float>(frames - 1);
  const std::int32_t last_interval = frames - 2;
  for (int i = 0; i < lines; ++i) {
    const float at = here + aside_m * frames_per_m[i];
    const float least = at < 0.0f ? 0.0f : at;
    const float position = least > last ? last : least;
    const auto whole = static_cast<std::int32_t>(position);
    before[i] = whole > last_interval ? last_interval : whole;
    share[i] = position - static_cast<float>(before[i]);
  }
}

LateralSum::LateralSum(const ApertureCone& cone, const BeamSection& section, const LossGrid& grid)
    : cone_(cone),
      section_(section),
      grid_(grid),
      margin_(section.most_lines() + 2),
      rows_(static_cast<std::size_t>(kRows) * static_cast<std::size_t>(grid.lines + 2 * margin_)) {
  const auto lines = static_cast<std::size_t>(grid.lines);
  shares_.resize(lines);
  for (auto& weights : weights_) weights.resize(lines);
  sums_.resize(lines * 2 * ApertureCone::kEnds);
  power_.resize(lines);
}

const double* LateralSum::power(int node, const Reaching& reaching) {
  std::copy_n(reaching.amplitude, grid_.lines, row(kPaths) + margin_);
  std::copy_n(reaching.material, grid_.lines, row(kPaths + 1) + margin_);
  for (int number = 0; number < kRows; ++number) extend(number);
  std::ranges::fill(power_, 0.0);
  for (int point = 0; point < BeamSection::kPoints; ++point) {
    weigh(section_.lines_aside(node, point), reaching);
    for (int end = 0; end < ApertureCone::kEnds; ++end) sum_waves(end, node, point);
    add_power(sum(0), sum(1), grid_.lines, power_.data());
  }
  const double* free = section_.lateral_power(node);
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
    weigh_beside(row(kPaths + 1) + lines,
                 reaching.material,
                 shares_.data(),
                 grid_.lines,
                 weights_[i].data(),
                 weights_[2].data());
    scale_to_axis(row(kPaths) + lines, reaching.amplitude, grid_.lines, weights_[i].data());
  }
}

WaveRow LateralSum::sum(int end) {
  double* real = sums_.data() + static_cast<std::ptrdiff_t>(2 * end * grid_.lines);
  return {real, real + grid_.lines};
}

void LateralSum::sum_waves(int end, int node, int point) {
  const WaveRow to = sum(end);
  std::fill_n(to.real, 2 * grid_.lines, 0.0);
  const int before = static_cast<int>(std::floor(section_.lines_aside(node, point)));
  for (int part = 0; part < ApertureCone::kLateral; ++part) {
    const float* own = paths(end, part);
    add_wave({own + before, own + before + 1, own},
             {weights_[0].data(), weights_[1].data(), weights_[2].data()},
             cone_.on_array(end, part, node),
             section_.lateral(end, node, point)[part],
             grid_.lines,
             to);
  }
}

ElevationSum::ElevationSum(const BeamSection& section, const LossGrid& grid, const LossTable& table)
    : section_(section), grid_(grid), table_(table) {
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
  for (int point = 0; point < BeamSection::kPoints; ++point) {
    weigh(frame, node, point);
    sum_waves(frame, node, point, parts);
    add_power(wave, wave, grid_.lines, power_.data());
  }
  const float* own = parts + row(frame, node, 0);
  const double free = section_.elevation_power(node);
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

/// Neighbouring lines mostly have the same frame before a point and are processed together.
template <class Run>
void ElevationSum::for_runs(Run run) const {
  for (int first = 0, end = 0; first < grid_.lines; first = end) {
    const std::int32_t before = before_[static_cast<std::size_t>(first)];
    while (end < grid_.lines && before_[static_cast<std::size_t>(end)] == before) ++end;
    run(first, end - first, before);
  }
}

void ElevationSum::weigh(int frame, int node, int point) {
  locate_frames(frame,
                grid_.frames,
                section_.across_m(node, point),
                section_.frames_per_m(node),
                grid_.lines,
                before_.data(),
                shares_[1].data());
  std::ranges::transform(shares_[1], shares_[0].begin(), [](float share) { return 1 - share; });
  const auto material = [&](int of_frame, int line) {
    return table_.material(node) + static_cast<std::ptrdiff_t>(of_frame) * grid_.lines + line;
  };
  std::ranges::fill(weights_[2], 1.0f);
  for_runs([&](int first, int count, int before) {
    for (int i = 0; i < 2; ++i) {
      weigh_beside(material(before + i, first),
                   material(frame, first),
                   shares_[i].data() + first,
                   count,
                   weights_[i].data() + first,
                   weights_[2].data() + first);
    }
  });
}

void ElevationSum::sum_waves(int frame, int node, int point, const float* parts) {
  std::ranges::fill(sums_, 0.0);
  for_runs([&](int first, int count, int before) {
    for (int part = 0; part < ApertureCone::kElevation; ++part) {
      const float* at = parts + first;
      add_wave({at + row(before, node, part),
                at + row(before + 1, node, part),
                at + row(frame, node, part)},
               {weights_[0].data() + first, weights_[1].data() + first, weights_[2].data() + first},
               whole_.data(),
               section_.elevation(node, point)[part],
               count,
               {sums_.data() + first, sums_.data() + grid_.lines + first});
    }
  });
}

}  // namespace wobblebench::sim
