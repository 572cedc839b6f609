// Pass 2: slice coordinates of a position in the probe frame: x and depth in the image plane, in
// metres, and the fractional frame index (SliceGeometry); `inside`: in the cone of valid data.
uniform float r_min_m, r_max_m;
uniform float tan_half_sector;
uniform float frame_skew;  // SliceGeometry::frame_skew
uniform float first_frame, last_frame;  // SliceVolume::covered

#if !PAIRS

// From the LUT for the motion direction (paper section 3.2).
layout(binding = BIND_MOTION_TABLE) uniform sampler2D motion_table;

uniform vec2 motion_scale, motion_offset;  // (y, z) to texture coordinates

vec3 to_slices(vec3 position, out bool inside) {
  vec3 motion = textureLod(motion_table, position.yz * motion_scale + motion_offset, 0.0).xyz;
  float depth = motion.x, frame = motion.y;
#if SKEWED
  frame -= frame_skew * atan(position.x, depth);
#endif
  float r = length(vec2(position.x, depth));
  inside = motion.z > 0.99 && frame >= first_frame && frame <= last_frame && depth > 0.0 &&
           r >= r_min_m && r <= r_max_m && abs(position.x) <= depth * tan_half_sector;
  return vec3(position.x, depth, frame);
}

#else

// In closed form (hw::ProbeGeometry).
uniform float axis_z_m;
uniform float frames_per_rad, middle_frame;
#if FRAMES == 1
uniform float phi_min_rad, phi_max_rad;
#endif

vec3 slice_coordinates(vec3 position, out float phi) {
  float along = position.z - axis_z_m;
  float side = along < 0.0 ? -1.0 : 1.0;
  float depth = axis_z_m + side * length(vec2(position.y, along));
  phi = -atan(position.y / (along == 0.0 ? 1e-30 : along));
  float frame = middle_frame + frames_per_rad * phi;
#if SKEWED
  frame -= frame_skew * atan(position.x, depth);
#endif
  return vec3(position.x, depth, frame);
}

// The cone of valid data is the sector in the image plane times the fan across the planes.
bool in_sector(vec3 slice) {
  float r2 = dot(slice.xy, slice.xy);
  return slice.y > 0.0 && r2 >= r_min_m * r_min_m && r2 <= r_max_m * r_max_m &&
         abs(slice.x) <= slice.y * tan_half_sector;
}

bool in_fan(float frame, float phi) {
#if FRAMES == 1
  return phi >= phi_min_rad && phi <= phi_max_rad;
#else
  return frame >= first_frame && frame <= last_frame;
#endif
}

vec3 to_slices(vec3 position, out bool inside) {
  float phi;
  vec3 slice = slice_coordinates(position, phi);
  inside = in_sector(slice) && in_fan(slice.z, phi);
  return slice;
}

#endif
