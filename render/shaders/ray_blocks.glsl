// Pass 2, mode fast: BUFFER samples at a time, where there is no kernel along the ray. The places
// of samples in the circular buffer are then constants, and the buffer stays in registers; a
// loop's own cost, which on a CPU is that of a fetch, falls on many samples.
float older[BUFFER];  // the block before

void empty_block() {
  for (int j = 0; j < BUFFER; ++j) older[j] = 0.0;
  taken = 0;
  difference = 0.0;
}

// Samples from `begin` on; true when the ray ends there.
bool look_at_block(inout March march, int begin, int count) {
  const int half_buffer = BUFFER / 2;
  float newer[BUFFER];
  bool inside[BUFFER];
#if STRAIGHT
  // Places among the slices run along a parabola through the block's ends and middle.
  float phi;
  vec3 first = slice_coordinates(place_of(march, begin), phi);
  vec3 middle = slice_coordinates(place_of(march, begin + half_buffer), phi);
  vec3 last = slice_coordinates(place_of(march, begin + BUFFER), phi);
#endif
  for (int j = 0; j < BUFFER; ++j) {
#if STRAIGHT
    float share = float(j) / float(BUFFER);
    vec3 at = (1.0 - share) * (1.0 - 2.0 * share) * first +
              4.0 * share * (1.0 - share) * middle + share * (2.0 * share - 1.0) * last;
    inside[j] = in_sector(at) && in_fan(at.z, 0.0);
#else
    bool in_cone;
    vec3 at = slice_place(place_of(march, begin + j), in_cone);
    inside[j] = in_cone;
#endif
    newer[j] = fetch_slices(at);
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
        last_difference = difference;
        float halfway = j < half_buffer ? older[(j + half_buffer) % BUFFER]
                                        : newer[(j + half_buffer) % BUFFER];
        difference += edge_sign * (newer[j] - 2.0 * halfway + older[j]);
        ++taken;
        if (march.detecting && taken >= BUFFER && difference >= threshold) {
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
