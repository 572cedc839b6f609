// Pass 2, shared: the ray of a pixel and the boxes that it is clipped to.

// Camera of render/camera.h.
uniform vec3 center_m;
uniform vec3 right;
uniform vec3 down;
uniform vec3 forward;
uniform float pixel_m;
uniform float image_size;
uniform float plane_distance_m;
uniform float eye_distance_m;
// Boxes in which rays begin and end, in the probe frame.
uniform vec3 start_center_m, start_half_m;
uniform vec3 end_center_m, end_half_m;
uniform float step_m;

// Span of a ray inside a box, as ray lengths; empty if y < x.
vec2 clip_to_box(vec3 origin, vec3 direction, vec3 center, vec3 half_size) {
  vec3 one = (center - half_size - origin) / direction;
  vec3 other = (center + half_size - origin) / direction;
  vec3 enter = min(one, other), leave = max(one, other);
  float from = 0.0, to = 1e30;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] != 0.0) {
      from = max(from, enter[axis]);
      to = min(to, leave[axis]);
    } else if (abs(origin[axis] - center[axis]) > half_size[axis]) {
      return vec2(0.0, -1.0);
    }
  }
  return vec2(from, to);
}

struct Ray {
  vec3 origin, direction;
};

// The ray through a point of the picture, in pixels; centres of pixels lie at integers + 1/2.
Ray picture_ray(vec2 picture) {
  vec2 offset = (picture - 0.5 * image_size) * pixel_m;
  vec3 on_plane = offset.x * right + offset.y * down;
#if PERSPECTIVE
  return Ray(center_m - eye_distance_m * forward, normalize(on_plane + eye_distance_m * forward));
#else
  return Ray(center_m + on_plane - plane_distance_m * forward, forward);
#endif
}

Ray pixel_ray() { return picture_ray(gl_FragCoord.xy); }
