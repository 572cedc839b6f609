// A detector that knows everything about a stick but where its surface is: the yardstick that shows
// whether the bound can be reached.
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "bench/evaluation/bound/edge_signal.h"

namespace wobblebench::bench {

/// Places that the oracle tries: low_m, low_m + step_m, ...
struct SearchGrid {
  double low_m = 0;
  double step_m = 0;
  int places = 0;
};

/// The signal for a surface at a place: where the beam's width varies, the rise does.
using EdgeSignalAt = std::function<EdgeSignal(double edge_m)>;

using IqSamples = std::vector<std::complex<float>>;

/// Most likely place of the surface on each stick, by the log likelihood -log det R - z* R^-1 z on
/// the grid and the parabola through its maximum and the neighbours; a maximum at the grid's end
/// stays there. The samples of all sticks lie at first_m, first_m + spacing, ...; all sticks have
/// the same number.
std::vector<double> most_likely_edges_m(const EdgeSignalAt& signal,
                                        double first_m,
                                        const std::vector<IqSamples>& sticks,
                                        const SearchGrid& search);

}  // namespace wobblebench::bench
