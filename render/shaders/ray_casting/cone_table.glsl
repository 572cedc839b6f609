// Pass 2, mode plain: slice coordinates of a position in the probe frame, from the LUT for the
// motion direction (paper section 3.2).
layout(binding = BIND_MOTION_TABLE) uniform sampler2D motion_table;

uniform vec2 motion_scale, motion_offset;  // (y, z) to texture coordinates
uniform float r_min_m, r_max_m;
uniform float tan_half_sector;
uniform float frame_skew;  // SliceGeometry::frame_skew

// x and depth in the image plane, in metres, and fractional frame index; `inside`: in the cone of
// valid data.
vec3 to_slices(vec3 position, out bool inside) {
  vec3 motion = textureLod(motion_table, position.yz * motion_scale + motion_offset, 0.0).xyz;
  float depth = motion.x, frame = motion.y;
#if SKEWED
  frame -= frame_skew * atan(position.x, depth);
#endif
  float r = length(vec2(position.x, depth));
  inside = motion.z > 0.99 && frame >= 0.0 && frame <= float(FRAMES - 1) && depth > 0.0 &&
           r >= r_min_m && r <= r_max_m && abs(position.x) <= depth * tan_half_sector;
  return vec3(position.x, depth, frame);
}
