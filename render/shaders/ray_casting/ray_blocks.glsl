// Pass 2, mode fast without a kernel along the ray: edge detection (Eq. (1)) and blending of BUFFER
// samples at a time. Indices into the circular buffer are then constants, the buffer stays in
// registers, and the loop overhead, on a CPU as large as a fetch, is shared by many samples.
float older[BUFFER];  // samples of the block before

void empty_block() {
  for (int j = 0; j < BUFFER; ++j) older[j] = 0.0;
  taken = 0;
  difference = 0.0;
}

// Processes the samples of steps `begin` to `begin` + BUFFER - 1, at most `count` - 1; true if the
// ray ends among them.
bool process_block(inout March march, int begin, int count) {
  const int half_buffer = BUFFER / 2;
  float newer[BUFFER];
  bool inside[BUFFER];
#if STRAIGHT
  // Slice coordinates follow a parabola through those of the block's ends and middle.
  float phi;
  vec3 first = slice_coordinates(sample_position(march, begin), phi);
  vec3 middle = slice_coordinates(sample_position(march, begin + half_buffer), phi);
  vec3 last = slice_coordinates(sample_position(march, begin + BUFFER), phi);
#endif
  for (int j = 0; j < BUFFER; ++j) {
#if STRAIGHT
    float t = float(j) / float(BUFFER);
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
  for (int j = 0; j < BUFFER; ++j) {
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
        float halfway = j < half_buffer ? older[(j + half_buffer) % BUFFER]
                                        : newer[(j + half_buffer) % BUFFER];
        difference += edge_sign * (newer[j] - 2.0 * halfway + older[j]);
        ++taken;
        if (march.detecting && taken >= BUFFER && difference >= threshold) {  // the edge becomes z
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
