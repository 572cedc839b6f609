#include "sim/optics/beam_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/optics/beam_row.h"

namespace wobblebench::sim {

namespace {

constexpr double kRow_m = 1e-3;
constexpr int kMaxRows = 320;
constexpr int kMinRows = 16;
constexpr int kColumns = 40;  ///< the response at the middle of a column has an error of -38 dB
constexpr int kSideLobeColumns = 96;
static_assert(kMaxRows * 2 * kSideLobeColumns <= BeamTable::kMaxEntries);
static_assert(kMaxRows * BeamTable::kElevationParts * kSideLobeColumns <= BeamTable::kMaxEntries);
/// Fraction of the beam's power that lies beyond its reach in each direction.
constexpr double kPowerBeyond = 8e-3;
constexpr double kPowerBeyondSideLobes = 5e-5;
/// Smallest angle between two sticks with lateral tables.
constexpr double kAngleStep_rad = 0.3 * kDegree;

double largest_amplitude(const SampledRow& row, const PulseBand& band) {
  double largest = 0;
  for (const auto& value : row.values) largest = std::max(largest, band.power(value));
  return std::sqrt(largest);
}

/// Samples a direction of the beam and writes its table.
class DirectionWriter {
 public:
  DirectionWriter(const PulseBand& band, int rows, int columns, double rows_per_m)
      : band_(band), rows_(rows), columns_(columns), rows_per_m_(rows_per_m) {}

  const PulseBand& band() const { return band_; }
  int rows() const { return rows_; }
  double range_m(int row) const { return (row + 0.5) / rows_per_m_; }
  std::vector<SampledRow> sample(const BeamPlane& plane) const {
    const auto reaches = plane.reaches_m(range_m(0), 1 / rows_per_m_, rows_);
    std::vector<SampledRow> sampled;
    for (int row = 0; row < rows_; ++row) {
      const double reach_m = reaches[static_cast<std::size_t>(row)];
      sampled.push_back(plane.sample(range_m(row), reach_m, columns_));
    }
    return sampled;
  }

  /// The lateral table. `scale`: factor of each row.
  BeamTable::Direction write(const std::vector<SampledRow>& sampled,
                             const std::vector<double>& scale) const {
    BeamTable::Direction direction{.part_columns = 2 * columns_};
    for (std::size_t row = 0; row < sampled.size(); ++row) {
      const RowDelay delay = fit_delay(sampled[row], band_);
      direction.rows.push_back(beam_row(sampled[row].reach_m, delay));
      append(aligned(sampled[row], delay, band_, scale[row]), direction);
    }
    return direction;
  }

  /// The elevation table, several parts per row. Reach and delay of a part lie on the row's lines.
  BeamTable::Direction write_parts(const std::vector<SampledRow>& sampled,
                                   const BeamPlane& plane) const {
    BeamTable::Direction direction{.parts = BeamTable::kElevationParts, .part_columns = columns_};
    for (const SampledRow& row : sampled) {
      direction.rows.push_back(beam_row(row.reach_m, fit_delay(row, band_)));
    }
    for (int row = 0; row < rows_; ++row) {
      const auto line = [&](float BeamRow::*member) {
        return line_around(
            row, rows_, rows_per_m_, [&](std::size_t i) { return direction.rows[i].*member; });
      };
      for (int part = 0; part < direction.parts; ++part) {
        const double at_m = (row + (part + 0.5) / direction.parts) / rows_per_m_;
        const double reach_m = columns_ / line(&BeamRow::columns_per_m).at(at_m);
        const RowDelay delay{
            line(&BeamRow::delay_m).at(at_m), 0, line(&BeamRow::curvature_per_m).at(at_m)};
        const SampledRow here = plane.sample(at_m, reach_m, columns_);
        append(aligned(here, delay, band_, 1 / largest_amplitude(here, band_)), direction);
      }
    }
    return direction;
  }

 private:
  BeamRow beam_row(double reach_m, const RowDelay& delay) const {
    return {static_cast<float>(columns_ / reach_m),
            static_cast<float>(delay.delay_m),
            static_cast<float>(delay.tilt),
            static_cast<float>(delay.curvature_per_m)};
  }

  void append(const std::vector<PulseBand::Values>& row, BeamTable::Direction& to) const {
    for (const PulseBand::Values& from : row) {
      BandValues& values = to.values.emplace_back();
      for (int node = 0; node < band_.nodes(); ++node) {
        const std::complex<double>& value = from[static_cast<std::size_t>(node)];
        values.re[node] = static_cast<float>(value.real());
        values.im[node] = static_cast<float>(value.imag());
      }
    }
  }

  PulseBand band_;
  int rows_;
  int columns_;
  double rows_per_m_;
};

/// The middle stick's rows, whose scales are used for all sticks.
struct MiddleStick {
  std::vector<SampledRow> lateral, elevation;
  std::vector<double> elevation_scale;
  std::vector<double> lateral_scale;  ///< makes the peak of an echo on the axis 1
  std::vector<std::array<double, PulseBand::kNodes>> power_m2;  ///< of each row, as BeamTable

  MiddleStick(const DirectionWriter& writer, const BeamPlane& in_plane, const BeamPlane& across)
      : lateral(writer.sample(in_plane)), elevation(writer.sample(across)) {
    for (int i = 0; i < writer.rows(); ++i) {
      const double range_m = writer.range_m(i);
      scale(writer.band(),
            static_cast<std::size_t>(i),
            in_plane.on_axis(range_m),
            across.on_axis(range_m));
    }
  }

 private:
  void scale(const PulseBand& band,
             std::size_t row,
             const PulseBand::Values& lateral_axis,
             const PulseBand::Values& elevation_axis) {
    elevation_scale.push_back(1 / largest_amplitude(elevation[row], band));
    PulseBand::Values on_axis = {};
    for (int node = 0; node < band.nodes(); ++node) {
      const auto i = static_cast<std::size_t>(node);
      on_axis[i] = elevation_scale[row] * elevation_axis[i] * lateral_axis[i];
    }
    lateral_scale.push_back(1 / band.peak(on_axis));
    auto& power = power_m2.emplace_back();
    for (std::size_t i = 0; i < power.size(); ++i) {
      power[i] = elevation_scale[row] * elevation_scale[row] * elevation[row].power_m(i) *
                 lateral_scale[row] * lateral_scale[row] * lateral[row].power_m(i);
    }
  }
};

/// Equidistant stick angles on one side of the sector.
struct StickAngles {
  double first_rad;
  double step_rad;
  int count;

  explicit StickAngles(const hw::AcquisitionPlan& plan) {
    const int sticks = plan.acquisition().sticks_per_frame;
    first_rad = std::abs(plan.theta_rad(sticks / 2));
    step_rad = std::max(kAngleStep_rad, plan.theta_step_rad());
    const double farthest = std::abs(plan.theta_rad(sticks - 1));
    count = 1 + static_cast<int>(std::ceil((farthest - first_rad) / step_rad - 0.5));
  }
};

}  // namespace

BeamTable::BeamTable(const ProbeOptics& optics, BeamShape shape, const FrequencyCourse& course)
    : columns_(shape == BeamShape::side_lobes ? kSideLobeColumns : kColumns), band_(optics.band()) {
  const double depth_m = optics.plan().acquisition().depth_m;
  const int count = std::clamp(static_cast<int>(std::ceil(depth_m / kRow_m)), kMinRows, kMaxRows);
  rows_per_m_ = count / depth_m;
  const StickAngles angles(optics.plan());
  first_angle_rad_ = angles.first_rad;
  angle_step_rad_ = angles.step_rad;
  const BeamReach reach{shape == BeamShape::side_lobes ? kPowerBeyondSideLobes : kPowerBeyond,
                        course};
  const DirectionWriter writer(band_, count, columns_, rows_per_m_);
  const auto in_plane = [&](int angle) {
    return BeamPlane::lateral(optics, angles.first_rad + angle * angles.step_rad, reach);
  };
  const BeamPlane across = BeamPlane::elevation(optics, reach);
  const MiddleStick middle(writer, in_plane(0), across);
  elevation_ = writer.write_parts(middle.elevation, across);
  power_m2_ = middle.power_m2;
  lateral_.resize(static_cast<std::size_t>(angles.count));
  lateral_[0] = writer.write(middle.lateral, middle.lateral_scale);
  parallel_ranges(angles.count - 1, optics.threads(), [&](int first, int last) {
    for (int angle = first + 1; angle <= last; ++angle) {
      lateral_[static_cast<std::size_t>(angle)] =
          writer.write(writer.sample(in_plane(angle)), middle.lateral_scale);
    }
  });
}

int BeamTable::row(double range_m) const {
  return std::clamp(static_cast<int>(range_m * rows_per_m_), 0, rows() - 1);
}

int BeamTable::part(double range_m, int parts) const {
  const double within = range_m * rows_per_m_ - row(range_m);
  return std::clamp(static_cast<int>(within * parts), 0, parts - 1);
}

double BeamTable::area_m2(int row) const {
  const auto& power_m2 = power_m2_[static_cast<std::size_t>(row)];
  const auto weights = band_.weights();
  return std::inner_product(power_m2.begin(), power_m2.end(), weights.begin(), 0.0);
}

double BeamTable::lateral_reach_m(int row) const {
  double most = 0;
  for (const Direction& lateral : lateral_) most = std::max(most, reach_m(lateral, row));
  return most;
}

std::size_t BeamTable::lateral_of(double theta_rad) const {
  const double steps = std::round((std::abs(theta_rad) - first_angle_rad_) / angle_step_rad_);
  return static_cast<std::size_t>(std::clamp(steps, 0.0, static_cast<double>(lateral_.size() - 1)));
}

BeamBounds::BeamBounds(const BeamTable& table,
                       const BeamTable::Direction& lateral,
                       double depth_m,
                       double margin_m)
    : per_m_(1 / kStep_m) {
  const int count = static_cast<int>(std::ceil(depth_m * per_m_)) + 1;
  const int window = static_cast<int>(std::ceil(margin_m * per_m_)) + 1;
  for (int i = 0; i < count; ++i) {
    Reach reach{0, 0};
    const int last = table.row((i + window) * kStep_m);
    for (int row = table.row((i - window) * kStep_m); row <= last; ++row) {
      reach.lateral_m = std::max(reach.lateral_m, table.reach_m(lateral, row));
      reach.elevation_m = std::max(reach.elevation_m, table.reach_m(table.elevation(), row));
    }
    reach_.push_back(reach);
    widest_.lateral_m = std::max(widest_.lateral_m, reach.lateral_m);
    widest_.elevation_m = std::max(widest_.elevation_m, reach.elevation_m);
  }
}

}  // namespace wobblebench::sim
