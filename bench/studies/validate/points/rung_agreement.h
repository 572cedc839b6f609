// Echoes of many points at once against tests/yardstick: echo_points.csv, echoes.csv.
#pragma once

#include <span>
#include <vector>

#include "bench/studies/validate/common/study_report.h"
#include "bench/studies/validate/points/point_targets.h"

namespace wobblebench::bench {

struct EchoAgreement {
  double sector_fraction = 0;
  double range_m = 0;
  double correlation = 0;  ///< of the envelope with the table's
  double level_db = 0;     ///< its root mean square over the table's
  long n = 0;              ///< samples
};

/// At each of `places`, of the standard preset. Rungs `scatterers` and `reference`. These normalise
/// a point's echo to the middle stick's axis at the point's own range, the table at the place's
/// range: amplitudes are multiplied by the ratio, from the levels of point_widths.csv.
std::vector<EchoAgreement> measure_agreement(const PointRung& rung,
                                             std::span<const EchoPlace> places);

StudyReport rung_agreement_report();

}  // namespace wobblebench::bench
