// Vectorised loops over the lines of a frame.
#pragma once

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

/// row[i] = near[i] + share[i] * (far[i] - near[i]).
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

/// gain[line] = what the axis gains from node to node, its inverse transmission, and the nepers it
/// absorbs.
void step_axis(const LossRows& rows, int lines, float* gain, float* nepers);

}  // namespace wobblebench::sim
