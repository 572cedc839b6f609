// A detector that knows everything about a stick but the range of its surface: it shows whether the
// bound can be reached. With the signals and bounds that only its check needs.
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "bench/evaluation/bound/detection_bound.h"
#include "bench/evaluation/bound/edge_signal.h"

namespace wobblebench::bench {

/// Ranges that the oracle tries: low_m, low_m + step_m, ...
struct SearchGrid {
  double low_m = 0;
  double step_m = 0;
  int count = 0;
};

/// The signal for a surface at a range: where the beam's width varies, the rise does.
using EdgeSignalAt = std::function<EdgeSignal(double edge_m)>;

using IqSamples = std::vector<std::complex<float>>;

/// Most likely range of the surface on each stick, by the log likelihood -log det R - z* R^-1 z on
/// the grid and the parabola through its maximum and the neighbours; a maximum at the grid's end
/// stays there. The samples of all sticks lie at first_m, first_m + spacing, ...; all sticks have
/// the same number.
std::vector<double> most_likely_edges_m(const EdgeSignalAt& signal,
                                        double first_m,
                                        const std::vector<IqSamples>& sticks,
                                        const SearchGrid& search);

/// Homogeneous speckle multiplied by the root of the mean power, as on the rung `field`.
EdgePair edge_after_pulse(SpeckleCorrelation correlation, EdgeRise rise);

/// covariance_information() of independent samples of these variances: the sum of
/// (d log variance)^2. Intensities of such samples are exponential and have the same information:
/// their phase carries none.
double independent_information(std::span<const double> variance,
                               std::span<const double> derivative);

/// detection_bound_m() of one stick from its detected samples: one intensity for each
/// `detected_spacing_m`, taken as independent. No phase and no display scale enters, so log
/// compression loses nothing but what it clips.
double envelope_bound_m(const DetectionConditions& conditions, double detected_spacing_m);

}  // namespace wobblebench::bench
