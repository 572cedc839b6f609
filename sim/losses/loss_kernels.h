// Vectorised loops over the samples of one stretch of a stick.
#pragma once

#include <span>

namespace wobblebench::sim {

/// The logarithm of an amplitude along a stretch: transmitted - n + the gain of the band
/// (sim/losses/band_loss.h), where n = nepers + i * per_sample.
struct LevelLine {
  double log_transmitted = 0;
  double nepers = 0;  ///< at the first sample
  double per_sample = 0;
};

/// values[i] = amplitude * ratio^i * change^(i (i - 1) / 2).
void fill_decay(double amplitude, double ratio, double change, int count, float* values);

/// values[i] = from + i * per_sample, at least `least`.
void fill_ramp(double from, double per_sample, double least, int count, float* values);

/// Adds linear interpolation in `nodes` at the positions from + i * per_sample, from 0 on; beyond
/// the last node its value.
void add_interpolated(
    std::span<const float> nodes, double from, double per_sample, int count, float* values);

/// values[i] = the amplitude of a line, times exp(values[i]); at most 1, at least 1e-35.
/// `variance` and `most_nepers` are those of the BandLoss, `most_narrow` bounds the loss at f0.
void fill_levels(const LevelLine& line,
                 double variance,
                 double most_nepers,
                 double most_narrow,
                 int count,
                 float* values);

}  // namespace wobblebench::sim
