// Pass 3, shared: conversions between picture coordinates (pixels; pixel centres at integers + 1/2)
// and the viewer's axes (right, down, forward; origin in the middle of the view plane if parallel,
// at the eye if perspective).
uniform float pixel_m;
uniform float image_size;
uniform float eye_distance_m;

// Direction of the ray through a point of the picture.
vec3 view_direction(vec2 picture) {
#if PERSPECTIVE
  return normalize(vec3((picture - 0.5 * image_size) * pixel_m, eye_distance_m));
#else
  return vec3(0.0, 0.0, 1.0);
#endif
}

vec3 view_position(vec2 picture, float depth) {
#if PERSPECTIVE
  return depth * view_direction(picture);
#else
  return vec3((picture - 0.5 * image_size) * pixel_m, depth);
#endif
}

// Picture coordinates (xy, pixels) and depth (z, metres) of a position.
vec3 to_picture(vec3 position) {
#if PERSPECTIVE
  return vec3(position.xy * (eye_distance_m / position.z) / pixel_m + 0.5 * image_size,
              length(position));
#else
  return vec3(position.xy / pixel_m + 0.5 * image_size, position.z);
#endif
}

// Speed in the picture, in pixels per metre along a unit direction, on the faster of the two axes.
float pixels_per_m(vec3 position, vec3 direction) {
#if PERSPECTIVE
  vec2 speed = (direction.xy * position.z - position.xy * direction.z) * eye_distance_m /
               (position.z * position.z) / pixel_m;
#else
  vec2 speed = direction.xy / pixel_m;
#endif
  return max(abs(speed.x), abs(speed.y));
}

// Selects, of the values of the quadrants (-x, -y), (+x, -y), (-x, +y), (+x, +y), that of a
// direction, given as the signs of its components.
float quadrant(vec4 values, bvec2 positive) {
  vec2 pair = positive.y ? values.zw : values.xy;
  return positive.x ? pair.y : pair.x;
}
