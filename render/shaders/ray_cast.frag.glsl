// Pass 2: one ray a pixel through the stack of slices; alpha blending and edge detection, Eq. (1).
//
// Filter semantics "ray_space": the taps of the 3D kernel lie one step apart along the ray and
// across it. The front plane of taps is fetched at each step and the last KERNEL plane sums are
// kept, so a step costs one plane of fetches (the paper's pipelining of samples).
layout(binding = BIND_SLICES) uniform sampler3D slices;
layout(binding = BIND_MOTION_TABLE) uniform sampler2D motion_table;
layout(binding = BIND_TRANSFER) uniform sampler2D transfer;

// Camera: see render/camera.h.
uniform vec3 center_m;
uniform vec3 right;
uniform vec3 down;
uniform vec3 forward;
uniform float pixel_m;
uniform float image_size;
uniform float plane_distance_m;
uniform float eye_distance_m;
// Where rays begin, and where they end.
uniform vec3 start_center_m, start_half_m;
uniform vec3 end_center_m, end_half_m;
uniform float step_m;
// Cone of valid data and the slices' grid: see render/slice_geometry.h.
uniform vec2 motion_scale, motion_offset;  // (y, z) to texture coordinates
uniform float r_min_m, r_max_m;
uniform float tan_half_sector;
uniform vec2 slice_scale, slice_offset;  // (x, depth) to texture coordinates
// 3D kernel, computed on the CPU: weights along the ray, and across it for buffer and blend.
uniform float along_weights[KERNEL];
uniform float buffer_weights[TAPS];
uniform float blend_weights[TAPS];

uniform float threshold;
uniform float edge_sign;  // +1: rising, -1: falling
uniform float opacity_limit;

layout(location = 0) out vec4 color;  // volume picture: RGB and opacity
layout(location = 1) out float z;     // ray length at the surface; negative: none

const int HALF_KERNEL = KERNEL / 2;
const int HALF_TAPS = TAPS / 2;

// The sample at a place of the probe frame, and 1; two zeros outside the cone.
vec2 sample_at(vec3 place) {
  vec3 motion = textureLod(motion_table, place.yz * motion_scale + motion_offset, 0.0).xyz;
  float depth = motion.x, frame = motion.y;
  float r = length(vec2(place.x, depth));
  bool inside = motion.z > 0.99 && frame >= 0.0 && frame <= float(FRAMES - 1) && depth > 0.0 &&
                r >= r_min_m && r <= r_max_m && abs(place.x) <= depth * tan_half_sector;
  if (!inside) return vec2(0.0);
  vec3 at = vec3(vec2(place.x, depth) * slice_scale + slice_offset, (frame + 0.5) / float(FRAMES));
  return vec2(textureLod(slices, at, 0.0).r, 1.0);
}

// Part of a ray inside a box; empty if y < x.
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

// Sums of value and weight over one plane of taps.
struct PlaneSum {
  vec2 buffered;
  vec2 blended;
  bool center_inside;
};

PlaneSum fetch_plane(vec3 place, vec3 across_1, vec3 across_2) {
  PlaneSum plane = PlaneSum(vec2(0.0), vec2(0.0), false);
  for (int j = 0; j < TAPS; ++j) {
    for (int i = 0; i < TAPS; ++i) {
      vec2 offset = vec2(i - HALF_TAPS, j - HALF_TAPS);
      vec2 tap = sample_at(place + offset.x * across_1 + offset.y * across_2);
      plane.buffered += buffer_weights[i] * buffer_weights[j] * tap;
#if BLEND
      plane.blended += blend_weights[i] * blend_weights[j] * tap;
#endif
      if (i == HALF_TAPS && j == HALF_TAPS) plane.center_inside = tap.y > 0.0;
    }
  }
  return plane;
}

struct Ray {
  vec3 origin, direction;
};

Ray pixel_ray() {
  vec2 offset = (gl_FragCoord.xy - 0.5 * image_size) * pixel_m;
  vec3 on_plane = offset.x * right + offset.y * down;
#if PERSPECTIVE
  return Ray(center_m - eye_distance_m * forward, normalize(on_plane + eye_distance_m * forward));
#else
  return Ray(center_m + on_plane - plane_distance_m * forward, forward);
#endif
}

// The circular buffer of Eq. (1), and Difference as a running sum.
float ring[BUFFER];
int oldest;  // place of the oldest sample
int taken;   // samples in a row inside the cone
float difference, last_difference;

void empty_buffer() {
  for (int i = 0; i < BUFFER; ++i) ring[i] = 0.0;
  oldest = 0;
  taken = 0;
  difference = 0.0;
}

// Takes the next sample; true if Difference of a full buffer has reached the threshold. The newest
// sample enters the newer half, the middle one moves to the older half, and the oldest leaves.
bool reaches_surface(float newest) {
  int middle = oldest + BUFFER / 2;
  if (middle >= BUFFER) middle -= BUFFER;
  last_difference = difference;
  difference += edge_sign * (newest - 2.0 * ring[middle] + ring[oldest]);
  ring[oldest] = newest;
  oldest = oldest + 1 == BUFFER ? 0 : oldest + 1;
  ++taken;
  return taken >= BUFFER && difference >= threshold;
}

// How many steps before the newest sample Difference passed the threshold.
float steps_past_crossing() {
#if REFINE_CROSSING
  if (taken > BUFFER) return (difference - threshold) / (difference - last_difference);
#endif
  return 0.0;
}

// Front to back, through the transfer function.
void blend(float value) {
  // First and last entries of the table hold the values 0 and 1.
  float at = (value * float(TRANSFER_SIZE - 1) + 0.5) / float(TRANSFER_SIZE);
  vec2 grey_and_opacity = textureLod(transfer, vec2(at, 0.5), 0.0).rg;
  float weight = (1.0 - color.a) * grey_and_opacity.g;
  color += vec4(vec3(weight * grey_and_opacity.r), weight);
}

void main() {
  color = vec4(0.0);
  z = NO_SURFACE;
  Ray ray = pixel_ray();
  vec2 start = clip_to_box(ray.origin, ray.direction, start_center_m, start_half_m);
  if (start.y < start.x) return;
  vec2 end = clip_to_box(ray.origin, ray.direction, end_center_m, end_half_m);
  // Samples lie in the middles of steps.
  int count = int(floor((end.y - start.x) / step_m + 0.5));
  vec3 across_1 = step_m * normalize(cross(down, ray.direction));
  vec3 across_2 = step_m * normalize(cross(ray.direction, across_1));

  PlaneSum planes[KERNEL];  // [KERNEL - 1]: the newest
  for (int k = 0; k < KERNEL; ++k) planes[k] = PlaneSum(vec2(0.0), vec2(0.0), false);
  empty_buffer();
  bool was_inside = false, detecting = DETECT != 0, blending = BLEND != 0;

  for (int front = -HALF_KERNEL; front < count + HALF_KERNEL; ++front) {
    for (int k = 0; k + 1 < KERNEL; ++k) planes[k] = planes[k + 1];
    float front_m = start.x + (float(front) + 0.5) * step_m;
    planes[KERNEL - 1] = fetch_plane(ray.origin + front_m * ray.direction, across_1, across_2);
    // The kernel is complete around the sample in its middle, HALF_KERNEL steps behind the front.
    int current = front - HALF_KERNEL;
    if (current < 0) continue;
    if (!planes[HALF_KERNEL].center_inside) {
#if STOP_ON_LEAVING_CONE
      if (was_inside) break;
#endif
      empty_buffer();
      continue;
    }
    was_inside = true;

    // Taps outside the cone carry no weight.
    vec2 buffered = vec2(0.0), blended = vec2(0.0);
    for (int k = 0; k < KERNEL; ++k) {
      buffered += along_weights[k] * planes[k].buffered;
      blended += along_weights[k] * planes[k].blended;
    }
#if DETECT
    if (detecting && reaches_surface(buffered.x / buffered.y)) {
      z = start.x + (float(current) + 0.5 - steps_past_crossing()) * step_m;
      detecting = false;
    }
#endif
#if BLEND
    if (blending) {
      blend(blended.x / blended.y);
      blending = color.a < opacity_limit;
    }
#endif
    // When both pictures are made, an opaque ray goes on until the surface is found, so that z does
    // not depend on the transfer function.
    if (!detecting && !blending) break;
  }
}
