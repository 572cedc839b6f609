// Pass 2, mode plain: where a place lies among the slices, from the LUT for the motion direction.
layout(binding = BIND_MOTION_TABLE) uniform sampler2D motion_table;

uniform vec2 motion_scale, motion_offset;  // (y, z) to texture coordinates
uniform float r_min_m, r_max_m;
uniform float tan_half_sector;
uniform float frame_skew;  // see SliceGeometry::frame_skew

// x and depth in the image plane, and frame; `inside` the cone of valid data.
vec3 slice_place(vec3 place, out bool inside) {
  vec3 motion = textureLod(motion_table, place.yz * motion_scale + motion_offset, 0.0).xyz;
  float depth = motion.x, frame = motion.y;
#if SKEWED
  frame -= frame_skew * atan(place.x, depth);
#endif
  float r = length(vec2(place.x, depth));
  inside = motion.z > 0.99 && frame >= 0.0 && frame <= float(FRAMES - 1) && depth > 0.0 &&
           r >= r_min_m && r <= r_max_m && abs(place.x) <= depth * tan_half_sector;
  return vec3(place.x, depth, frame);
}
