// Pass 2, mode fast without a kernel along the ray: edge detection and blending of BLOCK samples at
// a time. The loop overhead, on a CPU as large as a fetch, is shared by them.

// Whether a block's samples are inside the cone; fetches them.
void fetch_block(March march, int begin, out bool inside[BLOCK]) {
#if STRAIGHT
  // Slice coordinates follow a parabola through those of the block's ends and middle.
  float phi;
  vec3 first = slice_coordinates(sample_position(march, begin), phi);
  vec3 last = slice_coordinates(sample_position(march, begin + BLOCK), phi);
  vec3 middle_position =
      0.5 * (sample_position(march, begin) + sample_position(march, begin + BLOCK));
  vec3 middle = slice_coordinates(middle_position, phi);
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
    float value = fetch_slices(slice);
    newer[j] = inside[j] ? on_grid(value) : 0.0;
  }
}

// Processes the samples of steps `begin` to `begin` + BLOCK - 1, at most `count` - 1; true if the
// ray ends among them.
bool process_block(inout March march, int begin, int count) {
  bool inside[BLOCK];
  fetch_block(march, begin, inside);
  bool ended = false;
  for (int j = 0; j < BLOCK; ++j) {
    bool left = STOP_ON_LEAVING_CONE != 0 && march.was_inside && !inside[j];
    ended = ended || begin + j >= count || left;
    if (!ended) {
      march.was_inside = march.was_inside || inside[j];
#if DETECT
      bool reached = reaches_surface_in_block(inside[j], j);
      if (march.detecting && reached) {  // the edge becomes z
        z = march.start_m + (float(begin + j) + 0.5 - steps_past_crossing()) * step_m;
        march.detecting = false;
      }
#endif
#if BLEND
      if (march.blending && inside[j]) {
        blend(newer[j]);
        march.blending = color.a < opacity_limit;
      }
#endif
      ended = !march.detecting && !march.blending;
    }
  }
  end_block();
  return ended;
}
