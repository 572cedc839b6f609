// Pass 2, shared: the march along a pixel's ray. process_sample() is where an edge becomes z (edge
// detection, Eq. (1)) and where samples are alpha-blended, front to back.
layout(binding = BIND_TRANSFER) uniform sampler2D transfer;  // of an entry and of the next

uniform float opacity_limit;

layout(location = 0) out float z;     // ray length at the surface, in metres; negative: none
#if BLEND
layout(location = 1) out vec4 color;  // volume picture: RGB and opacity
#else
vec4 color;
#endif

struct March {
  Ray ray;
  float start_m;             // ray length of the first step; a sample lies in its step's middle
  vec3 across_1, across_2;   // one step across the ray
  bool was_inside;           // the cone of valid data
  bool detecting, blending;  // still to be done
};

March begin_march(Ray ray, float start_m) {
  vec3 across_1 = step_m * normalize(cross(down, ray.direction));
  vec3 across_2 = step_m * normalize(cross(ray.direction, across_1));
  return March(ray, start_m, across_1, across_2, false, DETECT != 0, BLEND != 0);
}

// Sets up the march of a pixel's ray and returns its number of steps; 0 if it misses the box.
int begin_pixel(out March march) {
  color = vec4(0.0);
  z = NO_SURFACE;
  Ray ray = pixel_ray();
  vec2 start = clip_to_box(ray.origin, ray.direction, start_center_m, start_half_m);
  march = begin_march(ray, start.x);
  if (start.y < start.x) return 0;
  vec2 end = clip_to_box(ray.origin, ray.direction, end_center_m, end_half_m);
  return int(floor((end.y - start.x) / step_m + 0.5));
}

vec3 sample_position(March march, int step) {
  return march.ray.origin + (march.start_m + (float(step) + 0.5) * step_m) * march.ray.direction;
}

// Grey and opacity of a value, linear between the table's entries, of which the first and the last
// hold the values 0 and 1. Each entry comes with the next: a driver's own filter fetches four.
vec2 transfer_at(float value) {
  float position = clamp(value, 0.0, 1.0) * float(TRANSFER_SIZE - 1);
  float entry = floor(position);
  vec4 both = textureLod(transfer, vec2((entry + 0.5) / float(TRANSFER_SIZE), 0.5), 0.0);
  return mix(both.rg, both.ba, position - entry);
}

// Alpha blending, front to back, through the transfer function.
void blend(float value) {
  vec2 grey_and_opacity = transfer_at(value);
  float weight = (1.0 - color.a) * grey_and_opacity.g;
  color += vec4(vec3(weight * grey_and_opacity.r), weight);
}

// Detection and blending for the sample of this step, in the kernel's middle; true if the ray ends.
bool process_sample(inout March march, int step) {
  Smoothed newest = smoothed();
#if DETECT
  bool reached = reaches_surface(newest.inside, newest.buffered);
#endif
  if (!newest.inside) return STOP_ON_LEAVING_CONE != 0 && march.was_inside;
  march.was_inside = true;
#if DETECT
  if (march.detecting && reached) {  // Eq. (1): the edge becomes z
    z = march.start_m + (float(step) + 0.5 - steps_past_crossing()) * step_m;
    march.detecting = false;
  }
#endif
#if BLEND
  if (march.blending) {
    blend(newest.blended);
    march.blending = color.a < opacity_limit;
  }
#endif
  // If both pictures are made, an opaque ray continues until the surface is found, so that z does
  // not depend on the transfer function.
  return !march.detecting && !march.blending;
}
