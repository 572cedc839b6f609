// What the neighbours of a stick tell beyond it.
#pragma once

#include <vector>

#include "bench/evaluation/bound/detection_bound.h"

namespace wobblebench::bench {

/// Eigenvalues of the correlation of the speckle of the stick and its neighbours: those sticks of a
/// line or frame whose axes lie within half the beam's -6 dB width. Where all see the surface at
/// its own place, their samples have the covariance C x S + N I (C: between sticks, S: along one),
/// and their information is the sum over the eigenvalues l of C of that of one stick with echo l S.
/// {1} where the sticks are farther apart. The correlation at a distance d is that of a Gaussian
/// beam of flat wave fronts, exp(-(d / 2 sigma)^2); curved ones out of focus correlate less, so
/// that neighbours closer than the beam is wide tell more than this.
std::vector<double> neighbour_modes(const DetectionConditions& conditions);

}  // namespace wobblebench::bench
