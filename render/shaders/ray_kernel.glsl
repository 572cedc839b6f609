// Pass 2, shared: samples of the slices, and the part of the 3D kernel that lies along the ray. The
// front plane of taps is fetched at each step and the last KERNEL plane sums are kept, so a step
// costs one plane of fetches (the paper's pipelining of samples).
#if PAIRS
layout(binding = BIND_SLICES) uniform sampler2DArray slices;  // red: a slice, green: the next
#else
layout(binding = BIND_SLICES) uniform sampler3D slices;
#endif

uniform vec2 slice_scale, slice_offset;  // (x, depth) to texture coordinates
// Kernel, computed on the CPU: weights along the ray, and across it for buffer and blend.
uniform float along_weights[KERNEL];
uniform float buffer_weights[TAPS];
uniform float blend_weights[TAPS];

const int HALF_KERNEL = KERNEL / 2;
const int HALF_TAPS = TAPS / 2;

float fetch_slices(vec3 at) {
  vec2 texel = at.xy * slice_scale + slice_offset;
#if PAIRS
  float pair = clamp(floor(at.z), 0.0, float(max(FRAMES - 2, 0)));
  vec2 both = textureLod(slices, vec3(texel, pair), 0.0).rg;
  return mix(both.x, both.y, at.z - pair);
#else
  return textureLod(slices, vec3(texel, (at.z + 0.5) / float(FRAMES)), 0.0).r;
#endif
}

// The sample at a place of the probe frame, and 1; two zeros outside the cone.
vec2 sample_at(vec3 place) {
  bool inside;
  vec3 at = slice_place(place, inside);
  if (!inside) return vec2(0.0);
  return vec2(fetch_slices(at), 1.0);
}

// A smoothed sample, where the kernel's middle lies inside the cone.
struct Smoothed {
  bool inside;
  float buffered;  // enters the buffer
  float blended;   // is blended
};

#if KERNEL == 1 && TAPS == 1
// The last sample itself.
vec2 newest;

void empty_kernel() {}

void fetch_front(vec3 place, vec3 across_1, vec3 across_2) { newest = sample_at(place); }

Smoothed smoothed() { return Smoothed(newest.y > 0.0, newest.x, newest.x); }
#else
// Sums of value and weight over one plane of taps.
struct PlaneSum {
  vec2 buffered;
  vec2 blended;
  bool center_inside;
};

// Over the planes of taps that the kernel spans; [KERNEL - 1]: the newest.
PlaneSum planes[KERNEL];

void empty_kernel() {
  for (int k = 0; k < KERNEL; ++k) planes[k] = PlaneSum(vec2(0.0), vec2(0.0), false);
}

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

// A step on, its plane around this place.
void fetch_front(vec3 place, vec3 across_1, vec3 across_2) {
  for (int k = 0; k + 1 < KERNEL; ++k) planes[k] = planes[k + 1];
  planes[KERNEL - 1] = fetch_plane(place, across_1, across_2);
}

// The kernel around the place HALF_KERNEL steps behind the front. Taps outside the cone carry no
// weight.
Smoothed smoothed() {
  vec2 buffered = vec2(0.0), blended = vec2(0.0);
  for (int k = 0; k < KERNEL; ++k) {
    buffered += along_weights[k] * planes[k].buffered;
    blended += along_weights[k] * planes[k].blended;
  }
  return Smoothed(planes[HALF_KERNEL].center_inside, buffered.x / buffered.y,
                  blended.x / blended.y);
}
#endif
