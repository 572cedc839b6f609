// Pass 2, shared: samples of the slices and the 3D Gaussian kernel in ray space. Each step fetches
// the front plane of taps and keeps the sums of the last KERNEL planes, so a step costs one plane
// of fetches (the pipelining of samples, paper section 3.2).
#if PAIRS
layout(binding = BIND_SLICES) uniform sampler2DArray slices;  // layer k: slices k, k + 1
#else
layout(binding = BIND_SLICES) uniform sampler3D slices;
#endif

uniform vec2 slice_scale, slice_offset;  // (x, depth) to texture coordinates
// Kernel weights, computed on the CPU (render/geometry/ray_sampling.h): along the ray, and across it
// for the sample that enters the buffer and for the one that is blended.
uniform float along_weights[KERNEL];
uniform float buffer_weights[TAPS];
uniform float blend_weights[TAPS];

const int HALF_KERNEL = KERNEL / 2;
const int HALF_TAPS = TAPS / 2;

// Interpolated value at slice coordinates.
float fetch_slices(vec3 slice) {
  vec2 uv = slice.xy * slice_scale + slice_offset;
#if PAIRS
  float pair = clamp(floor(slice.z), 0.0, float(max(FRAMES - 2, 0)));
  vec2 both = textureLod(slices, vec3(uv, pair), 0.0).rg;
  return mix(both.x, both.y, slice.z - pair);
#else
  return textureLod(slices, vec3(uv, (slice.z + 0.5) / float(FRAMES)), 0.0).r;
#endif
}

// Value and weight 1 at a position of the probe frame; (0, 0) outside the cone.
vec2 sample_at(vec3 position) {
  bool inside;
  vec3 slice = to_slices(position, inside);
  if (!inside) return vec2(0.0);
  return vec2(fetch_slices(slice), 1.0);
}

// A smoothed sample, valid if the kernel's middle lies inside the cone.
struct Smoothed {
  bool inside;
  float buffered;  // for the buffer of Eq. (1)
  float blended;   // for alpha blending
};

#if KERNEL == 1 && TAPS == 1
// Without a kernel: the last sample itself.
vec2 newest;

void empty_kernel() {}

void fetch_front(vec3 position, vec3 across_1, vec3 across_2) { newest = sample_at(position); }

Smoothed smoothed() { return Smoothed(newest.y > 0.0, newest.x, newest.x); }
#else
// Weighted sums of (value, weight) over one plane of taps.
struct PlaneSum {
  vec2 buffered;
  vec2 blended;
  bool center_inside;
};

// The planes of taps that the kernel spans; [KERNEL - 1] is the newest.
PlaneSum planes[KERNEL];

void empty_kernel() {
  for (int k = 0; k < KERNEL; ++k) planes[k] = PlaneSum(vec2(0.0), vec2(0.0), false);
}

void add_tap(inout PlaneSum plane, int i, int j, vec3 position, vec3 across_1, vec3 across_2) {
  vec2 offset = vec2(i - HALF_TAPS, j - HALF_TAPS);
  vec2 tap = sample_at(position + offset.x * across_1 + offset.y * across_2);
  plane.buffered += buffer_weights[i] * buffer_weights[j] * tap;
#if BLEND
  plane.blended += blend_weights[i] * blend_weights[j] * tap;
#endif
  if (i == HALF_TAPS && j == HALF_TAPS) plane.center_inside = tap.y > 0.0;
}

// A row, of at most 15 taps, is written out: a software driver counts the turns of all loops of a
// pixel (loop_turns() in render/passes/ray_caster.cpp).
#define ADD_TAP(i) add_tap(plane, i, j, position, across_1, across_2)

PlaneSum fetch_plane(vec3 position, vec3 across_1, vec3 across_2) {
  PlaneSum plane = PlaneSum(vec2(0.0), vec2(0.0), false);
  for (int j = 0; j < TAPS; ++j) {
    ADD_TAP(0);
#if TAPS > 1
    ADD_TAP(1);
    ADD_TAP(2);
#endif
#if TAPS > 3
    ADD_TAP(3);
    ADD_TAP(4);
#endif
#if TAPS > 5
    ADD_TAP(5);
    ADD_TAP(6);
#endif
#if TAPS > 7
    ADD_TAP(7);
    ADD_TAP(8);
#endif
#if TAPS > 9
    ADD_TAP(9);
    ADD_TAP(10);
#endif
#if TAPS > 11
    ADD_TAP(11);
    ADD_TAP(12);
#endif
#if TAPS > 13
    ADD_TAP(13);
    ADD_TAP(14);
#endif
  }
  return plane;
}

// Advances by one step: fetches the plane around this position.
void fetch_front(vec3 position, vec3 across_1, vec3 across_2) {
  for (int k = 0; k + 1 < KERNEL; ++k) planes[k] = planes[k + 1];
  planes[KERNEL - 1] = fetch_plane(position, across_1, across_2);
}

// The kernel's mean around the position HALF_KERNEL steps behind the front. Taps outside the cone
// carry no weight.
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
