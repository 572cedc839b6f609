#include "sim/scatterers/scatterer_scene.h"

#include <algorithm>
#include <cmath>

#include "sim/beam/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr double kRangeStep_m = 0.5e-3;

/// The product of the three -6 dB widths.
double resolution_cell_m3(const hw::AcquisitionPlan& plan, double range_m) {
  return lateral_fwhm_m(plan, range_m) * elevation_fwhm_m(plan, range_m) * axial_fwhm_m(plan);
}

/// Smallest and largest resolution cell at any range.
struct ResolutionCells {
  double smallest_m3 = HUGE_VAL;
  double largest_m3 = 0;

  explicit ResolutionCells(const hw::AcquisitionPlan& plan) {
    const double depth_m = plan.acquisition().depth_m;
    const int steps = std::max(1, static_cast<int>(depth_m / kRangeStep_m));
    for (int i = 1; i <= steps; ++i) {
      const double here_m3 = resolution_cell_m3(plan, depth_m * i / steps);
      smallest_m3 = std::min(smallest_m3, here_m3);
      largest_m3 = std::max(largest_m3, here_m3);
    }
  }
};

double half_diagonal(double side_m) {
  return 0.5 * std::sqrt(3.0) * side_m;
}

/// `full_power`: of a scatterer on the axis that contributes fully.
OctaveAtRow octave_at_row(double share, double full_power) {
  OctaveAtRow at;
  for (int i = 0; i < kScatterersInCell; ++i) {
    const double power = scatterer_power(share, i);
    const float amplitude = static_cast<float>(std::sqrt(full_power * power));
    if (power >= 1) {
      at.full = amplitude;
      ++at.full_count;
    } else if (power > 0) {
      at.partial = amplitude;
    }
    at.count += power > 0;
  }
  return at;
}

/// A table column near a row, as a straight line over the range through the row's two neighbours.
struct Line {
  float at_face;
  float slope_per_m;
};

template <class Value>
Line line_around(const BeamTable& table, int row, const Value& value) {
  const int before = std::max(row - 1, 0), behind = std::min(row + 1, table.rows() - 1);
  const auto at = [&](int i) { return static_cast<double>(value(static_cast<std::size_t>(i))); };
  const double slope =
      (at(behind) - at(before)) * table.rows_per_m() / std::max(1, behind - before);
  const double range_m = (row + 0.5) / table.rows_per_m();
  return {static_cast<float>(at(row) - slope * range_m), static_cast<float>(slope)};
}

}  // namespace

ScattererScene::ScattererScene(const ScannedTissue& scanned,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options,
                               const ScattererSettings& settings)
    : tissue(scanned),
      table(plan, settings.beam, options.threads),
      per_m3(options.scatterers_per_cell / ResolutionCells(plan).smallest_m3),
      pulse_m(std::sqrt(kPi) * sigma_of_fwhm(axial_fwhm_m(plan))),
      cells(per_m3,
            ResolutionCells(plan).largest_m3 / ResolutionCells(plan).smallest_m3,
            options.seed),
      blocks(scanned, plan, options, cells),
      bounds(table, plan.acquisition().depth_m, half_diagonal(cells.block_m)),
      reaches(reaches_around(table, cells.block_m)),
      rim(settings.beam == BeamShape::side_lobes ? BeamRim::diamond : BeamRim::ellipse),
      taps(plan, plan.sample_spacing_m() / iq_oversampling(plan)),
      cycles_per_m(2 * plan.probe().center_frequency_hz / plan.acquisition().sound_speed_m_s) {
  compute_octave_gains(plan, settings.all_octaves ? HUGE_VAL : options.scatterers_per_cell);
  tabulate_rows();
}

void ScattererScene::compute_octave_gains(const hw::AcquisitionPlan& plan, double per_cell) {
  const int count = static_cast<int>(cells.octaves.size());
  const int window =
      static_cast<int>(std::ceil(half_diagonal(cells.block_m) * table.rows_per_m())) + 1;
  gains.resize(cells.octaves.size());
  for (auto& gain : gains) gain.contributes.assign(static_cast<std::size_t>(table.rows()), 0);
  for (int row = 0; row < table.rows(); ++row) {
    const double range_m = (row + 0.5) / table.rows_per_m();
    const double needed = per_cell / resolution_cell_m3(plan, range_m);
    double density = 0;
    for (int i = 0; i < count; ++i) {
      density += cells.octaves[static_cast<std::size_t>(i)].per_m3 * cells.share(i, needed);
    }
    const double full_power = 1 / (density * table.area_m2(row) * pulse_m);
    for (int i = 0; i < count; ++i) {
      OctaveGain& gain = gains[static_cast<std::size_t>(i)];
      const double share = cells.share(i, needed);
      gain.rows.push_back(octave_at_row(share, full_power));
      if (share <= 0) continue;
      // The first and the last row of the table extend beyond its ends.
      const double begin_m = row / table.rows_per_m(), end_m = (row + 1) / table.rows_per_m();
      gain.begin_m = std::min(gain.begin_m, row == 0 ? -HUGE_VALF : static_cast<float>(begin_m));
      gain.end_m = row == table.rows() - 1 ? HUGE_VALF : static_cast<float>(end_m);
      const int from = std::max(0, row - window), to = std::min(table.rows() - 1, row + window);
      std::fill(gain.contributes.begin() + from, gain.contributes.begin() + to + 1, char{1});
    }
  }
}

void ScattererScene::tabulate_rows() {
  const auto& lateral_rows = table.lateral().rows;
  const auto& elevation_rows = table.elevation().rows;
  for (int row = 0; row < table.rows(); ++row) {
    const Line delay = line_around(table, row, [&](std::size_t i) {
      return lateral_rows[i].delay_m + elevation_rows[i].delay_m;
    });
    const Line lateral =
        line_around(table, row, [&](std::size_t i) { return lateral_rows[i].curvature_per_m; });
    const Line elevation =
        line_around(table, row, [&](std::size_t i) { return elevation_rows[i].curvature_per_m; });
    rows.push_back({lateral_rows[static_cast<std::size_t>(row)].columns_per_m,
                    elevation_rows[static_cast<std::size_t>(row)].columns_per_m,
                    delay.at_face,
                    1 + delay.slope_per_m,
                    lateral.at_face,
                    lateral.slope_per_m,
                    elevation.at_face,
                    elevation.slope_per_m});
  }
}

}  // namespace wobblebench::sim
