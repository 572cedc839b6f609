// The beam's table against the responses that it stores.
#include "sim/optics/beam_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "sim/optics/plane_response.h"

namespace wobblebench::sim {
namespace {

using Complex = std::complex<double>;

const hw::AcquisitionPlan& table_plan() {
  static const hw::AcquisitionPlan shared({}, {});
  return shared;
}

double middle_m(const BeamTable& table, int row) {
  return (row + 0.5) / table.rows_per_m();
}

double part_m(const BeamTable& table, const BeamTable::Direction& direction, int row, int part) {
  return (row + (part + 0.5) / direction.parts) / table.rows_per_m();
}

/// Stored responses of the middle of a part, with their delay.
PulseBand::Values stored(const BeamTable& table,
                         const BeamTable::Direction& direction,
                         int row,
                         int part,
                         int column,
                         double offset_m) {
  const PulseBand band(table_plan());
  const double range_m = part_m(table, direction, row, part);
  const auto property = [&](float BeamRow::*member) {
    return line_around(row,
                       table.rows(),
                       table.rows_per_m(),
                       [&](std::size_t i) { return direction.rows[i].*member; })
        .at(range_m);
  };
  const double delay_m =
      property(&BeamRow::delay_m) +
      (property(&BeamRow::tilt) + property(&BeamRow::curvature_per_m) * offset_m) * offset_m;
  PulseBand::Values result = {};
  const BandValues& value = direction.at(row, part, column);
  for (int node = 0; node < band.nodes(); ++node) {
    result[static_cast<std::size_t>(node)] =
        Complex(value.re[node], value.im[node]) *
        std::polar(1.0, -2 * band.wavenumber_per_m(node) * delay_m);
  }
  return result;
}

class BeamShapes : public testing::TestWithParam<BeamShape> {};

/// Normalised correlation of two rows over all offsets and nodes.
class Agreement {
 public:
  void add(const PulseBand::Values& a, const PulseBand::Values& b) {
    for (std::size_t node = 0; node < a.size(); ++node) {
      cross_ += a[node] * std::conj(b[node]);
      power_a_ += std::norm(a[node]);
      power_b_ += std::norm(b[node]);
    }
  }
  double value() const { return std::abs(cross_) / std::sqrt(power_a_ * power_b_); }

 private:
  Complex cross_ = 0;
  double power_a_ = 0, power_b_ = 0;
};

TEST_P(BeamShapes, RowsAreTheResponseOfTheirStick) {
  const BeamTable table(ProbeOptics(table_plan()), GetParam());
  const int columns = 2 * table.columns();
  for (double theta_deg : {0.0, 21.0, 38.5}) {
    const std::size_t angle = table.lateral_of(theta_deg * kDegree);
    // Lateral tables lie at the angles of the sticks.
    double nearest = 1;
    for (int line = 0; line < table_plan().acquisition().sticks_per_frame; ++line) {
      const double theta = table_plan().theta_rad(line);
      if (table.lateral_of(theta) == angle && theta > 0) nearest = theta;
    }
    const StickAperture aperture(ProbeOptics(table_plan()), nearest);
    const auto& direction = table.lateral()[angle];
    for (int row : {40, 41, 75, 120, 151}) {
      const auto response = PlaneResponse::lateral(aperture, middle_m(table, row));
      Agreement agreement;
      for (int c = 0; c < columns; ++c) {
        const double offset_m = (2 * (c + 0.5) / columns - 1) * table.reach_m(direction, row);
        const PlanePoint point{middle_m(table, row), offset_m};
        agreement.add(stored(table, direction, row, 0, c, offset_m),
                      response.at({&point, 1}).front());
      }
      EXPECT_GT(agreement.value(), 0.999999) << theta_deg << " " << row;
    }
  }
}

TEST_P(BeamShapes, PartsOfRowsAreTheResponseOfTheLens) {
  const BeamTable table(ProbeOptics(table_plan()), GetParam());
  const auto& direction = table.elevation();
  const PulseBand band(table_plan());
  const StickAperture middle(ProbeOptics(table_plan()), 0);
  for (int row : {30, 40, 41, 75, 120, 151}) {
    for (int part = 0; part < direction.parts; ++part) {
      const double range_m = part_m(table, direction, row, part);
      const auto response =
          PlaneResponse::elevation(ProbeOptics(table_plan()), InPlaneExcess(middle, range_m));
      // The last column ends where the line of the row's columns has it.
      const double columns_per_m =
          line_around(row, table.rows(), table.rows_per_m(), [&](std::size_t i) {
            return direction.rows[i].columns_per_m;
          }).at(range_m);
      Agreement agreement;
      for (int c = 0; c < table.columns(); ++c) {
        const PlanePoint point{range_m, (c + 0.5) / columns_per_m};
        agreement.add(stored(table, direction, row, part, c, point.offset_m),
                      response.at({&point, 1}).front());
      }
      EXPECT_GT(agreement.value(), 0.999999) << row << " " << part;
    }
  }
}

TEST_P(BeamShapes, AnEchoOnTheAxisHasAPeakOfOne) {
  const BeamTable table(ProbeOptics(table_plan()), GetParam());
  for (int row = 30; row < 150; row += 17) {
    const auto& lateral = table.lateral()[0];
    const auto at = static_cast<std::size_t>(row);
    const double step_m = 1 / static_cast<double>(lateral.rows[at].columns_per_m);
    const double across_m = 1 / static_cast<double>(table.elevation().rows[at].columns_per_m);
    PulseBand::Values product = stored(table, lateral, row, 0, table.columns(), 0.5 * step_m);
    const auto elevation = stored(table, table.elevation(), row, 0, 0, 0.5 * across_m);
    for (std::size_t node = 0; node < product.size(); ++node) product[node] *= elevation[node];
    EXPECT_NEAR(PulseBand(table_plan()).peak(product), 1, 0.04) << row;
  }
}

TEST_P(BeamShapes, ReachLeavesOutTheSameShareOfPowerAtEveryRange) {
  const BeamTable table(ProbeOptics(table_plan()), GetParam());
  const double beyond = GetParam() == BeamShape::main_lobe ? 0.008 : 5e-5;
  const PulseBand band(table_plan());
  for (int row = 20; row < table.rows(); row += 23) {
    const InPlaneExcess excess(StickAperture(ProbeOptics(table_plan()), 0), middle_m(table, row));
    const auto response = PlaneResponse::elevation(ProbeOptics(table_plan()), excess);
    const double reach_m = table.reach_m(table.elevation(), row);
    double within = 0, outside = 0;
    std::vector<PlanePoint> points;
    for (int i = 0; i < 2000; ++i) points.push_back({middle_m(table, row), (i + 0.5) * 20e-6});
    const auto values = response.at(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      (points[i].offset_m < reach_m ? within : outside) += band.power(values[i]);
    }
    // The search ends at the fifth side lobe, and the reach is interpolated between rows.
    EXPECT_LT(outside / (within + outside),
              GetParam() == BeamShape::main_lobe ? 1.6 * beyond : 12 * beyond)
        << row;
  }
}

INSTANTIATE_TEST_SUITE_P(Lobes,
                         BeamShapes,
                         testing::Values(BeamShape::main_lobe, BeamShape::side_lobes));

TEST(BeamTable, SticksHaveTheTableOfTheirAngle) {
  const BeamTable table(ProbeOptics(table_plan()), BeamShape::main_lobe);
  const int lines = table_plan().acquisition().sticks_per_frame;
  for (int line = 0; line < lines / 2; ++line) {
    EXPECT_EQ(table.lateral_of(table_plan().theta_rad(line)),
              table.lateral_of(table_plan().theta_rad(lines - 1 - line)));
    EXPECT_EQ(table.lateral_of(table_plan().theta_rad(line)),
              static_cast<std::size_t>(lines / 2 - 1 - line));
  }
}

}  // namespace
}  // namespace wobblebench::sim
