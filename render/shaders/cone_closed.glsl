// Pass 2, mode fast: where a place lies among the slices, in closed form (hw::ProbeGeometry).
uniform float axis_z_m;
uniform float frames_per_rad, middle_frame;
uniform float r_min_m, r_max_m;
uniform float tan_half_sector;
uniform float frame_skew;  // see SliceGeometry::frame_skew
#if FRAMES == 1
uniform float phi_min_rad, phi_max_rad;
#endif

// x and depth in the image plane, and frame.
vec3 slice_coordinates(vec3 place, out float phi) {
  float along = place.z - axis_z_m;
  float side = along < 0.0 ? -1.0 : 1.0;
  float depth = axis_z_m + side * length(vec2(place.y, along));
  phi = -atan(place.y / (along == 0.0 ? 1e-30 : along));
  float frame = middle_frame + frames_per_rad * phi;
#if SKEWED
  frame -= frame_skew * atan(place.x, depth);
#endif
  return vec3(place.x, depth, frame);
}

// Whether a place among the slices lies in the cone of valid data; in the fan apart.
bool in_sector(vec3 at) {
  float r2 = dot(at.xy, at.xy);
  return at.y > 0.0 && r2 >= r_min_m * r_min_m && r2 <= r_max_m * r_max_m &&
         abs(at.x) <= at.y * tan_half_sector;
}

bool in_fan(float frame, float phi) {
#if FRAMES == 1
  return phi >= phi_min_rad && phi <= phi_max_rad;
#else
  return frame >= 0.0 && frame <= float(FRAMES - 1);
#endif
}

vec3 slice_place(vec3 place, out bool inside) {
  float phi;
  vec3 at = slice_coordinates(place, phi);
  inside = in_sector(at) && in_fan(at.z, phi);
  return at;
}
