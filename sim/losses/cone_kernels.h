// Vectorised loops over the lines of a frame.
#pragma once

#include <complex>
#include <cstdint>

namespace wobblebench::sim {

/// Where a way lies among frames, for each line: the frame before, and the share of the distance to
/// the next. `aside_m` across the image plane of frame `frame`; positions end with the volume.
void locate_frames(int frame,
                   int frames,
                   float aside_m,
                   const float* frames_per_m,
                   int lines,
                   std::int32_t* before,
                   float* share);

/// row[i] = (1 - share[i]) * near[i] + share[i] * far[i]: positive where both are, also where one
/// is too small to change a difference.
void interpolate(const float* near, const float* far, const float* share, int count, float* row);

/// Amplitudes and absorbed amounts of a LossTable at a node and the next.
struct LossRows {
  const float* near_transmitted;
  const float* near_absorbed;
  const float* far_transmitted;
  const float* far_absorbed;
};

/// Takes ways one step further: multiplies `relative`, a way's amplitude over the axis', and adds
/// to `nepers`, what it absorbs more than the axis. The way lies between entries i and i + 1 of
/// `rows`, at `share`.
void step_ways(const LossRows& rows,
               float share,
               const float* axis_gain,
               const float* axis_nepers,
               int lines,
               float* relative,
               float* nepers);

/// sum[i] += factor * values[i].
void add_scaled(const float* values, float factor, int count, float* sum);
/// sum[i] += factors[i] * values[i].
void add_products(const float* values, const float* factors, int count, float* sum);

/// Of neighbouring sticks: the one-way amplitude that reaches the node before one, and the material
/// at it.
struct Reaching {
  const float* amplitude;
  const float* material;
};

/// What a stick beside a place counts for it, `share` of the place: weight[i] = share[i] times the
/// amplitude that reaches it, over that which reaches the stick itself. In another material it
/// counts nothing, and own[i], what remains for the stick itself, is not lessened by the share.
void weigh_beside(const Reaching& beside,
                  const Reaching& stick,
                  const float* share,
                  int count,
                  float* weight,
                  float* own);

/// Sums of waves at a place, for each line.
struct WaveRow {
  double* real;
  double* imaginary;
};

/// Values of the two sticks beside a place and of the stick itself, for each line.
struct PlaceRows {
  const float* first;
  const float* second;
  const float* own;
};

/// Adds wave * part[i] * the sum of the rows' amplitudes by their weights. `part`: what of the
/// aperture's part there is.
void add_wave(const PlaceRows& amplitude,
              const PlaceRows& weight,
              const float* part,
              std::complex<double> wave,
              int count,
              WaveRow sum);

/// power[i] += |transmit[i]|^2 |receive[i]|^2.
void add_power(WaveRow transmit, WaveRow receive, int count, double* power);

/// gain[line] = what the axis gains from node to node, its inverse transmission, and the nepers it
/// absorbs.
void step_axis(const LossRows& rows, int lines, float* gain, float* nepers);

}  // namespace wobblebench::sim
