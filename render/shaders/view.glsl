// Pixels in the viewer's axes (right, down, forward), from the middle of the view plane (parallel)
// or the eye (perspective). Shared by the shaders of pass 3.
uniform float pixel_m;
uniform float image_size;
uniform float eye_distance_m;

// Direction of the ray through a place of the picture; pixels' middles at whole numbers + 1/2.
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

// Where a place appears (xy), and its depth (z).
vec3 to_picture(vec3 place) {
#if PERSPECTIVE
  return vec3(place.xy * (eye_distance_m / place.z) / pixel_m + 0.5 * image_size, length(place));
#else
  return vec3(place.xy / pixel_m + 0.5 * image_size, place.z);
#endif
}

// How many pixels a place crosses for each metre that it moves along a unit direction, along the
// picture's faster axis.
float pixels_per_m(vec3 place, vec3 direction) {
#if PERSPECTIVE
  vec2 speed = (direction.xy * place.z - place.xy * direction.z) * eye_distance_m /
               (place.z * place.z) / pixel_m;
#else
  vec2 speed = direction.xy / pixel_m;
#endif
  return max(abs(speed.x), abs(speed.y));
}
