#include "sim/optics/beam_bounds.h"

#include <cmath>

namespace wobblebench::sim {

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
