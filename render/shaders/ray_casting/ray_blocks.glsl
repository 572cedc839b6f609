// Pass 2, mode fast without a kernel along the ray: edge detection (Eq. (1), or an iso-surface) and
// blending of BLOCK samples at a time; BLOCK is BUFFER for Eq. (1). Indices into the circular buffer are then constants, the buffer stays in
// registers, and the loop overhead, on a CPU as large as a fetch, is shared by many samples.
float older[BLOCK];  // samples of the block before

void empty_block() {
  for (int j = 0; j < BLOCK; ++j) older[j] = 0.0;
  taken = 0;
  difference = 0.0;
}

// Processes the samples of steps `begin` to `begin` + BLOCK - 1, at most `count` - 1; true if the
// ray ends among them.
bool process_block(inout March march, int begin, int count) {
  const int half_block = BLOCK / 2;
  float newer[BLOCK];
  bool inside[BLOCK];
#if STRAIGHT
  // Slice coordinates follow a parabola through those of the block's ends and middle.
  float phi;
  vec3 first = slice_coordinates(sample_position(march, begin), phi);
  vec3 middle = slice_coordinates(sample_position(march, begin + half_block), phi);
  vec3 last = slice_coordinates(sample_position(march, begin + BLOCK), phi);
#endif
  for (int j = 0; j < BLOCK; ++j) {
#if STRAIGHT
    float t = float(j) / float(BLOCK);
    vec3 slice = (1.0 - t) * (1.0 - 2.0 * t) * first + 4.0 * t * (1.0 - t) * middle +
                 t * (2.0 * t - 1.0) * last;
    inside[j] = in_sector(slice) && in_fan(slice.z, 0.0);
#else
    bool in_cone;
    vec3 slice = to_slices(sample_position(march, begin + j), in_cone);
    inside[j] = in_cone;
#endif
    newer[j] = fetch_slices(slice);
  }
  bool ended = false;
  for (int j = 0; j < BLOCK; ++j) {
    bool left = STOP_ON_LEAVING_CONE != 0 && march.was_inside && !inside[j];
    ended = ended || begin + j >= count || left;
    if (!ended) {
      march.was_inside = march.was_inside || inside[j];
      if (!inside[j]) {
        empty_block();
        for (int k = 0; k < BUFFER; ++k) newer[k] = k <= j ? 0.0 : newer[k];
      } else {
#if DETECT
        // As reaches_surface() of edge_detector.glsl.
        last_difference = difference;
#if DETECTOR == DETECTOR_ISO
        difference = edge_sign * (newer[j] - threshold);
        ++taken;
        bool reached = taken >= BUFFER && last_difference < 0.0 && difference >= 0.0;
#else
        float halfway = j < half_block ? older[(j + half_block) % BLOCK]
                                       : newer[(j + half_block) % BLOCK];
        difference += edge_sign * (newer[j] - 2.0 * halfway + older[j]);
        ++taken;
        bool reached = taken >= BUFFER && difference >= threshold;
#endif
        if (march.detecting && reached) {  // the edge becomes z
          z = march.start_m + (float(begin + j) + 0.5 - steps_past_crossing()) * step_m;
          march.detecting = false;
        }
#endif
#if BLEND
        if (march.blending) {
          blend(newer[j]);
          march.blending = color.a < opacity_limit;
        }
#endif
        ended = !march.detecting && !march.blending;
      }
    }
  }
  older = newer;
  return ended;
}
