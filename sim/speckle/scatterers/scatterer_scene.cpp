#include "sim/speckle/scatterers/scatterer_scene.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

constexpr double kRangeStep_m = 0.5e-3;
/// Largest slope of the logarithm of the density along the stick: tissue that moves along it keeps
/// most of its scatterers.
constexpr double kMostChange_per_m = 30;

double half_diagonal(double side_m) {
  return 0.5 * std::sqrt(3.0) * side_m;
}

/// `full_power`: power of a scatterer on the axis that contributes fully.
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

}  // namespace

ResolutionCells::ResolutionCells(const BeamProfile& profile, double depth_m)
    : smallest_m3(HUGE_VAL) {
  const int steps = std::max(1, static_cast<int>(depth_m / kRangeStep_m));
  for (int i = 1; i <= steps; ++i) {
    const double here_m3 = profile.resolution_cell_m3(depth_m * i / steps);
    smallest_m3 = std::min(smallest_m3, here_m3);
    largest_m3 = std::max(largest_m3, here_m3);
  }
}

ScattererScene::ScattererScene(const ScannedTissue& scanned,
                               const ProbeOptics& probe_optics,
                               const SimulationOptions& options,
                               const ScattererSettings& settings)
    : tissue(scanned),
      optics(probe_optics),
      table(optics, settings.beam, settings.course),
      course(settings.course),
      resolution(optics.profile(), optics.plan().acquisition().depth_m),
      per_m3(options.scatterers_per_cell / resolution.smallest_m3),
      pulse_m(optics.band().length_m()),
      cells(per_m3, resolution.largest_m3 / resolution.smallest_m3, options.seed),
      blocks(scanned, optics, options, cells),
      rim(settings.beam == BeamShape::side_lobes ? BeamRim::diamond : BeamRim::ellipse),
      taps(optics.band(), optics.iq_spacing_m()) {
  const double per_cell = settings.all_octaves ? HUGE_VAL : options.scatterers_per_cell;
  compute_octave_gains(per_cell);
  for (int i = 0; i < kBinPositions; ++i) {
    const double from_middle_m = ((i + 0.5) / kBinPositions - 0.5) * taps.spacing_m();
    BandValues& phasors = bin_phasors.emplace_back();
    for (int node = 0; node < PulseBand::kNodes; ++node) {
      const auto phasor = std::polar(1.0, -2 * optics.band().offset_per_m(node) * from_middle_m);
      phasors.re[node] = static_cast<float>(phasor.real());
      phasors.im[node] = static_cast<float>(phasor.imag());
    }
  }
  for (std::size_t i = 0; i < table.lateral().size(); ++i) {
    add_beam(i, optics.plan().acquisition().depth_m);
  }
}

int ScattererScene::window() const {
  return static_cast<int>(std::ceil(half_diagonal(cells.block_m) * table.rows_per_m())) + 1;
}

std::vector<double> ScattererScene::needed_per_m3(double per_cell) const {
  std::vector<double> needed;
  for (int row = 0; row < table.rows(); ++row) {
    const double range_m = (row + 0.5) / table.rows_per_m();
    const double narrower = course.at(range_m);  // factor in both directions
    needed.push_back(narrower * narrower * per_cell / optics.profile().resolution_cell_m3(range_m));
  }
  const double fade = std::exp(-kMostChange_per_m / table.rows_per_m());
  for (std::size_t i = 1; i < needed.size(); ++i) {
    needed[i] = std::max(needed[i], fade * needed[i - 1]);
  }
  for (std::size_t i = needed.size() - 1; i > 0; --i) {
    needed[i - 1] = std::max(needed[i - 1], fade * needed[i]);
  }
  return needed;
}

std::vector<OctaveAtRow> ScattererScene::octaves_at(int row, double needed_per_m3) const {
  const int count = static_cast<int>(cells.octaves.size());
  double density = 0;
  for (int i = 0; i < count; ++i) {
    density += cells.octaves[static_cast<std::size_t>(i)].per_m3 * cells.share(i, needed_per_m3);
  }
  const double full_power = 1 / (density * table.area_m2(row) * pulse_m);
  std::vector<OctaveAtRow> octaves;
  for (int i = 0; i < count; ++i) {
    octaves.push_back(octave_at_row(cells.share(i, needed_per_m3), full_power));
  }
  return octaves;
}

void ScattererScene::compute_octave_gains(double per_cell) {
  gains.resize(cells.octaves.size());
  for (auto& gain : gains) gain.contributes.assign(static_cast<std::size_t>(table.rows()), 0);
  const std::vector<double> needed = needed_per_m3(per_cell);
  for (int row = 0; row < table.rows(); ++row) {
    const std::vector<OctaveAtRow> octaves = octaves_at(row, needed[static_cast<std::size_t>(row)]);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      OctaveGain& gain = gains[i];
      gain.rows.push_back(octaves[i]);
      if (octaves[i].count == 0) continue;
      // The first and the last row of the table extend beyond its ends.
      const double begin_m = row / table.rows_per_m(), end_m = (row + 1) / table.rows_per_m();
      gain.begin_m = std::min(gain.begin_m, row == 0 ? -HUGE_VALF : static_cast<float>(begin_m));
      gain.end_m = row == table.rows() - 1 ? HUGE_VALF : static_cast<float>(end_m);
      const int from = std::max(0, row - window());
      const int to = std::min(table.rows() - 1, row + window());
      std::fill(gain.contributes.begin() + from, gain.contributes.begin() + to + 1, char{1});
    }
  }
}

void ScattererScene::add_beam(std::size_t angle, double depth_m) {
  const BeamTable::Direction& lateral = table.lateral()[angle];
  const BeamBounds bounds(table, lateral, depth_m, half_diagonal(cells.block_m));
  const std::vector<BlockReach> reaches = reaches_around(table, lateral, cells.block_m);
  const auto beam = [&](bool mirrored) {
    return StickBeam{rows_of(lateral, mirrored), bounds, reaches, lateral.values.data()};
  };
  beams.push_back({beam(false), beam(true)});
}

std::vector<BeamAtRow> ScattererScene::rows_of(const BeamTable::Direction& lateral,
                                               bool mirrored) const {
  const auto& lateral_rows = lateral.rows;
  const auto& elevation_rows = table.elevation().rows;
  const float sign = mirrored ? -1.0f : 1.0f;
  std::vector<BeamAtRow> rows;
  for (int row = 0; row < table.rows(); ++row) {
    BeamAtRow at;
    const auto line = [&](float& at_face, float& slope, const auto& value) {
      const RowLine found = line_around(row, table.rows(), table.rows_per_m(), value);
      at_face = static_cast<float>(found.at_face);
      slope = static_cast<float>(found.slope_per_m);
    };
    using Row = std::size_t;
    line(at.delay_m, at.range_scale, [&](Row i) {
      return static_cast<double>(lateral_rows[i].delay_m) +
             static_cast<double>(elevation_rows[i].delay_m);
    });
    at.range_scale += 1;
    line(at.lateral_columns_per_m, at.lateral_columns_slope_per_m2, [&](Row i) {
      return sign * lateral_rows[i].columns_per_m;
    });
    line(at.elevation_columns_per_m, at.elevation_columns_slope_per_m2, [&](Row i) {
      return elevation_rows[i].columns_per_m;
    });
    line(at.lateral_tilt, at.lateral_tilt_slope_per_m, [&](Row i) {
      return sign * lateral_rows[i].tilt;
    });
    line(at.lateral_curvature_per_m, at.lateral_curvature_slope_per_m2, [&](Row i) {
      return lateral_rows[i].curvature_per_m;
    });
    line(at.elevation_curvature_per_m, at.elevation_curvature_slope_per_m2, [&](Row i) {
      return elevation_rows[i].curvature_per_m;
    });
    at.first_index = first_table_index(row, table.columns());
    rows.push_back(at);
  }
  return rows;
}

const StickBeam& ScattererScene::beam(const hw::Ray& stick) const {
  const double theta_rad = stick_angle_rad(stick);
  return beams[table.lateral_of(theta_rad)][theta_rad < 0 ? 1 : 0];
}

EchoConstants ScattererScene::echo_constants(const StickBeam& beam, std::int32_t last_bin) const {
  return {beam.lateral,
          table.elevation().values.data(),
          static_cast<float>(optics.band().center_per_m() / kPi),
          static_cast<float>(taps.spacing_m()),
          bin_phasors.data(),
          last_bin};
}

}  // namespace wobblebench::sim
