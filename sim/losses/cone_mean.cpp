#include "sim/losses/cone_mean.h"

#include <algorithm>
#include <cmath>

#include "sim/math/fast_math.h"

namespace wobblebench::sim {

WOBBLEBENCH_SIMD void interpolate(const float* __restrict near,
                                  const float* __restrict far,
                                  const float* __restrict share,
                                  int count,
                                  float* __restrict row) {
  for (int i = 0; i < count; ++i) row[i] = (1.0f - share[i]) * near[i] + share[i] * far[i];
}

WOBBLEBENCH_SIMD void step_paths(const LossRows& rows,
                                 float share,
                                 const float* __restrict axis_gain,
                                 const float* __restrict axis_nepers,
                                 int lines,
                                 float* __restrict relative,
                                 float* __restrict nepers) {
  constexpr float kLeast = 1e-30f;
  const float* __restrict t0 = rows.near_transmitted;
  const float* __restrict d0 = rows.near_absorbed;
  const float* __restrict t1 = rows.far_transmitted;
  const float* __restrict d1 = rows.far_absorbed;
  const float rest = 1.0f - share;
  for (int i = 0; i < lines; ++i) {
    const float near = 1.0f / (rest * t0[i] + share * t0[i + 1]);
    const float far = rest * t1[i] + share * t1[i + 1];
    const float near_absorbed = rest * d0[i] + share * d0[i + 1];
    const float far_absorbed = rest * d1[i] + share * d1[i + 1];
    const float amplitude = relative[i] * (far * near) * axis_gain[i];
    relative[i] = amplitude < kLeast ? kLeast : amplitude;
    nepers[i] += far_absorbed / far - near_absorbed * near - axis_nepers[i];
  }
}

namespace {

/// For each step from node to node on the axis: gain[line] is its inverse transmission,
/// nepers[line] its absorption.
WOBBLEBENCH_SIMD void step_axis(const LossRows& rows,
                                int lines,
                                float* __restrict gain,
                                float* __restrict nepers) {
  const float* __restrict t0 = rows.near_transmitted;
  const float* __restrict d0 = rows.near_absorbed;
  const float* __restrict t1 = rows.far_transmitted;
  const float* __restrict d1 = rows.far_absorbed;
  for (int i = 0; i < lines; ++i) {
    gain[i] = t0[i] / t1[i];
    nepers[i] = d1[i] / t1[i] - d0[i] / t0[i];
  }
}

/// sum[i] += factor * values[i].
WOBBLEBENCH_SIMD void add_scaled(const float* __restrict values,
                                 float factor,
                                 int count,
                                 float* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += factor * values[i];
}

/// sum[i] += factors[i] * values[i].
WOBBLEBENCH_SIMD void add_products(const float* __restrict values,
                                   const float* __restrict factors,
                                   int count,
                                   float* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += factors[i] * values[i];
}

}  // namespace

ConeMean::ConeMean(const ApertureCone& cone,
                   const BeamSection& section,
                   const LossGrid& grid,
                   const LossTable& table,
                   const BandLoss& band)
    : cone_(cone),
      section_(section),
      grid_(grid),
      table_(table),
      band_(band),
      elevations_(grid.frames > 1 ? ApertureCone::kElevation : 1),
      margin_(cone.most_lines() + 2),
      paths_(static_cast<std::size_t>(ApertureCone::kEnds * ApertureCone::kLateral * elevations_)),
      lateral_(cone, section, grid),
      elevation_(section, grid, table) {
  const auto lines = static_cast<std::size_t>(grid.lines);
  for (auto& row : rows_) row.resize(lines + 2 * static_cast<std::size_t>(margin_));
  for (auto* values : {&axis_gain_, &axis_nepers_, &between_}) values->resize(lines);
  before_.resize(lines);
}

std::size_t ConeMean::parts_size(const LossGrid& grid) {
  if (grid.frames == 1) return 0;
  return static_cast<std::size_t>(grid.nodes) * ApertureCone::kElevation *
         static_cast<std::size_t>(grid.lines);
}

void ConeMean::follow(int frame,
                      std::span<float> log_gain,
                      std::span<float> frequency,
                      std::span<float> parts) {
  find_differing(frame);
  const auto differs = std::ranges::find(differs_, 1) - differs_.begin();
  for (int node = 1; node < grid_.nodes; ++node) {
    const bool same_losses = node <= differs;
    if (!same_losses || elevations_ > 1) follow_to(node, frame);
    const double* power = same_losses ? nullptr : average(node, frame, log_gain, frequency);
    if (elevations_ > 1) {
      const auto first = static_cast<std::size_t>(node * ApertureCone::kElevation * grid_.lines);
      average_parts(node, frame, power, parts.data() + first);
    }
  }
}

void ConeMean::add_elevation(int frame, std::span<const float> parts, std::span<float> log_gain) {
  if (elevations_ == 1) return;
  for (int node = first_differing(frame) + 1; node < grid_.nodes; ++node) {
    const double* power = elevation_.power_over_mean(frame, node, parts.data());
    for (int line = 0; line < grid_.lines; ++line) {
      log_gain[static_cast<std::size_t>(line * grid_.nodes + node)] +=
          static_cast<float>(0.5 * std::log(power[line]));
    }
  }
}

void ConeMean::lift_lone_sticks(int frame, std::span<float> log_gain) const {
  // Of the zone that such a stick stands for only the middle is known. Tissue behind one that is
  // half as wide as the beam loses 4 dB, two-way, which are 0.46 nepers.
  constexpr double kDeepest = 0.46;
  std::vector<double> level(static_cast<std::size_t>(grid_.lines));
  for (int node = first_differing(frame) + 1; node < grid_.nodes; ++node) {
    const float* axis = table_.transmitted(node) + static_cast<std::ptrdiff_t>(frame) * grid_.lines;
    const auto gain = [&](std::size_t line) -> float& {
      return log_gain[line * static_cast<std::size_t>(grid_.nodes) +
                      static_cast<std::size_t>(node)];
    };
    for (std::size_t line = 0; line < level.size(); ++line) {
      level[line] = 2 * std::log(static_cast<double>(axis[line])) + static_cast<double>(gain(line));
    }
    for (std::size_t line = 1; line + 1 < level.size(); ++line) {
      const double darker = std::min(level[line - 1], level[line + 1]);
      const double lift = darker - kDeepest - level[line];
      if (lift <= 0 || !share_material(node, frame, static_cast<int>(line))) continue;
      gain(line) += static_cast<float>(lift);
    }
  }
}

/// True if a stick and its neighbours are in one material at a node or at the node before.
bool ConeMean::share_material(int node, int frame, int line) const {
  const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(frame) * grid_.lines + line;
  const auto same = [at](const float* material) {
    return material[at - 1] == material[at] && material[at] == material[at + 1];
  };
  return same(table_.material(node)) || same(table_.material(node - 1));
}

int ConeMean::first_differing(int frame) const {
  for (int node = 0; node + 1 < grid_.nodes; ++node) {
    const int reach = cone_.most_frames(node) + section_.most_frames() + 1;
    if (table_.differs(
            node, std::max(frame - reach, 0), std::min(frame + reach, grid_.frames - 1))) {
      return node;
    }
  }
  return grid_.nodes;
}

void ConeMean::find_differing(int frame) {
  differs_.clear();
  for (int node = 0; node + 1 < grid_.nodes; ++node) {
    const int reach = cone_.most_frames(node);
    const bool differs =
        table_.differs(node, std::max(frame - reach, 0), std::min(frame + reach, grid_.frames - 1));
    differs_.push_back(differs ? 1 : 0);
  }
}

void ConeMean::follow_to(int node, int frame) {
  for (RayPaths& each : paths_) {
    each.relative.assign(static_cast<std::size_t>(grid_.lines), 1.0f);
    each.nepers.assign(static_cast<std::size_t>(grid_.lines), 0.0f);
  }
  for (int from = 0; from + 1 < node; ++from) {
    if (differs_[static_cast<std::size_t>(from)] == 0) continue;
    load_axis(from, frame);
    for (int elevation = 0; elevation < elevations_; ++elevation) {
      load_rows(elevation, from, node, frame);
      step(elevation, from, node);
    }
  }
}

void ConeMean::load_axis(int from, int frame) {
  const auto row = static_cast<std::ptrdiff_t>(frame) * grid_.lines;
  const LossRows rows{table_.transmitted(from) + row,
                      table_.absorbed(from) + row,
                      table_.transmitted(from + 1) + row,
                      table_.absorbed(from + 1) + row};
  step_axis(rows, grid_.lines, axis_gain_.data(), axis_nepers_.data());
}

void ConeMean::load_rows(int elevation, int from, int to, int frame) {
  planes_[0] = table_.transmitted(from);
  planes_[1] = table_.absorbed(from);
  planes_[2] = table_.transmitted(from + 1);
  planes_[3] = table_.absorbed(from + 1);
  if (elevations_ > 1) {
    const auto aside_m = static_cast<float>(cone_.elevation_m(elevation, from, to));
    locate_frames(frame,
                  grid_.frames,
                  aside_m,
                  cone_.frames_per_m(from),
                  grid_.lines,
                  before_.data(),
                  between_.data());
    blend_frames();
  } else {
    for (std::size_t i = 0; i < std::size(rows_); ++i) {
      std::copy_n(planes_[i], grid_.lines, rows_[i].data() + margin_);
    }
  }
  for (auto& row : rows_) extend(row);
}

/// Neighbouring lines mostly have the same frame before a path and are interpolated together.
void ConeMean::blend_frames() {
  for (int first = 0, end = 0; first < grid_.lines; first = end) {
    const std::int32_t before = before_[static_cast<std::size_t>(first)];
    while (end < grid_.lines && before_[static_cast<std::size_t>(end)] == before) ++end;
    const auto at = static_cast<std::ptrdiff_t>(before) * grid_.lines + first;
    for (std::size_t i = 0; i < std::size(rows_); ++i) {
      interpolate(planes_[i] + at,
                  planes_[i] + at + grid_.lines,
                  between_.data() + first,
                  end - first,
                  rows_[i].data() + margin_ + first);
    }
  }
}

void ConeMean::extend(std::vector<float>& row) const {
  float* first = row.data() + margin_;
  std::fill_n(row.data(), margin_, *first);
  std::fill_n(first + grid_.lines, margin_, first[grid_.lines - 1]);
}

LossRows ConeMean::rows_at(int lines_aside) const {
  const int first = margin_ + lines_aside;
  return {rows_[0].data() + first,
          rows_[1].data() + first,
          rows_[2].data() + first,
          rows_[3].data() + first};
}

void ConeMean::step(int elevation, int from, int to) {
  for (int end = 0; end < ApertureCone::kEnds; ++end) {
    for (int part = 0; part < ApertureCone::kLateral; ++part) {
      const float aside = cone_.lines_aside(end, part, from, to);
      const float before = std::floor(aside);
      RayPaths& followed = paths_[path(end, part, elevation)];
      step_paths(rows_at(static_cast<int>(before)),
                 aside - before,
                 axis_gain_.data(),
                 axis_nepers_.data(),
                 grid_.lines,
                 followed.relative.data(),
                 followed.nepers.data());
    }
  }
}

/// Mean absorption of the paths minus that of the axis, weighted by their amplitudes.
double ConeMean::nepers_aside(int end, int node, int line) const {
  const auto at = static_cast<std::size_t>(line);
  double sum = 0, absorbed = 0;
  for (int part = 0; part < ApertureCone::kLateral; ++part) {
    const auto share = static_cast<double>(cone_.on_array(end, part, node)[line]);
    for (int elevation = 0; elevation < elevations_; ++elevation) {
      const RayPaths& each = paths_[path(end, part, elevation)];
      const double amplitude = share * static_cast<double>(each.relative[at]);
      sum += amplitude;
      absorbed += amplitude * static_cast<double>(each.nepers[at]);
    }
  }
  return absorbed / sum;
}

const double* ConeMean::average(int node,
                                int frame,
                                std::span<float> log_gain,
                                std::span<float> frequency) {
  const auto row = static_cast<std::ptrdiff_t>(frame) * grid_.lines;
  load_lateral();
  const double* power =
      lateral_.power(node, {table_.transmitted(node) + row, table_.material(node) + row});
  for (int line = 0; line < grid_.lines; ++line) {
    const double axis_nepers = 2 * static_cast<double>(table_.absorbed(node)[row + line]) /
                               static_cast<double>(table_.transmitted(node)[row + line]);
    const double aside = nepers_aside(0, node, line) + nepers_aside(1, node, line);
    const double nepers = std::max(axis_nepers + aside, 0.0);
    const auto to = static_cast<std::size_t>(line * grid_.nodes + node);
    log_gain[to] = static_cast<float>(0.5 * std::log(power[line]) + band_.log_gain(nepers) -
                                      band_.log_gain(axis_nepers));
    frequency[to] =
        static_cast<float>(band_.frequency_ratio(nepers) - band_.frequency_ratio(axis_nepers));
  }
  return power;
}

void ConeMean::load_lateral() {
  const float each = 1.0f / static_cast<float>(elevations_);
  for (int end = 0; end < ApertureCone::kEnds; ++end) {
    for (int part = 0; part < ApertureCone::kLateral; ++part) {
      float* mean = lateral_.paths(end, part);
      std::fill_n(mean, grid_.lines, 0.0f);
      for (int elevation = 0; elevation < elevations_; ++elevation) {
        const RayPaths& followed = paths_[path(end, part, elevation)];
        add_scaled(followed.relative.data(), each, grid_.lines, mean);
      }
    }
  }
}

void ConeMean::average_parts(int node, int frame, const double* power, float* parts) const {
  std::fill_n(parts, ApertureCone::kElevation * grid_.lines, 0.0f);
  for (int end = 0; end < ApertureCone::kEnds; ++end) {
    for (int part = 0; part < ApertureCone::kLateral; ++part) {
      const float* on_array = cone_.on_array(end, part, node);
      for (int elevation = 0; elevation < elevations_; ++elevation) {
        const RayPaths& followed = paths_[path(end, part, elevation)];
        float* to = parts + static_cast<std::ptrdiff_t>(elevation) * grid_.lines;
        add_products(followed.relative.data(), on_array, grid_.lines, to);
      }
    }
  }
  const float* axis = table_.transmitted(node) + static_cast<std::ptrdiff_t>(frame) * grid_.lines;
  for (int line = 0; line < grid_.lines; ++line) {
    const auto part = [&](int elevation) -> float& {
      return parts[elevation * grid_.lines + line];
    };
    double mean = 0;
    for (int i = 0; i < elevations_; ++i) mean += static_cast<double>(part(i)) / elevations_;
    const double relative = power == nullptr ? 1 : std::sqrt(std::sqrt(power[line]));
    const double arriving = static_cast<double>(axis[line]) * relative;
    for (int i = 0; i < elevations_; ++i) {
      part(i) = static_cast<float>(static_cast<double>(part(i)) / mean * arriving);
    }
  }
}

}  // namespace wobblebench::sim
