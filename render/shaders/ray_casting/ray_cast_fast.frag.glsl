// Pass 2, mode fast: one ray per pixel, which leaps over macrocells without surface and opacity
// (empty-space leaping); otherwise as mode plain.

// Without a kernel along the ray: edge detection and blending of BLOCK samples at a time. The loop
// overhead, on a CPU as large as a fetch, is shared by them.

// Slice coordinates of the first step of the next block, and its position.
vec3 block_slice, block_position;

void move_to_block(March march, int begin) {
  float phi;
  block_position = sample_position(march, begin);
  block_slice = slice_coordinates(block_position, phi);
}

// Whether a block's samples are inside the cone; fetches them. Moves on to the next block.
void fetch_block(March march, int begin, out bool inside[BLOCK]) {
#if STRAIGHT
  // Slice coordinates follow a parabola through those of the block's ends and middle.
  float phi;
  vec3 first = block_slice, begin_position = block_position;
  move_to_block(march, begin + BLOCK);
  vec3 last = block_slice;
  vec3 middle = slice_coordinates(0.5 * (begin_position + block_position), phi);
  vec3 slope = 4.0 * middle - 3.0 * first - last, curvature = 2.0 * (first + last - 2.0 * middle);
#else
  move_to_block(march, begin + BLOCK);
#endif
  for (int j = 0; j < BLOCK; ++j) {
#if STRAIGHT
    float t = float(j) / float(BLOCK);
    vec3 slice = first + t * (slope + t * curvature);
    inside[j] = in_sector(slice) && in_fan(slice.z, 0.0);
#else
    bool in_cone;
    vec3 slice = to_slices(sample_position(march, begin + j), in_cone);
    inside[j] = in_cone;
#endif
    float value = fetch_slices(slice);
    newer[j] = inside[j] ? on_grid(value) : 0.0;
  }
}

#if DETECT
// State of the detector at the sample where it found the surface.
struct Found {
  int step, taken;
  float difference, last_difference;
};
Found found;

// The edge becomes z.
void place_surface(March march) {
  taken = found.taken;
  difference = found.difference;
  last_difference = found.last_difference;
  z = march.start_m + (float(found.step) + 0.5 - steps_past_crossing()) * step_m;
}
#endif

// Processes the samples of steps `begin` to `begin` + BLOCK - 1, at most `count` - 1; true if the
// ray ends among them. A software driver executes both sides of each branch: what need not be done
// for every sample waits for place_surface().
bool process_block(inout March march, int begin, int count) {
  bool inside[BLOCK];
  fetch_block(march, begin, inside);
  bool ended = false;
  for (int j = 0; j < BLOCK; ++j) {
    bool left = STOP_ON_LEAVING_CONE != 0 && march.was_inside && !inside[j];
    ended = ended || j >= count - begin || left;
    march.was_inside = march.was_inside || inside[j];
#if DETECT
    bool reached = reaches_surface_in_block(inside[j], j);
    if (reached && march.detecting && !ended) {
      found = Found(begin + j, taken, difference, last_difference);
      march.detecting = false;
    }
#endif
#if BLEND
    if (march.blending && inside[j] && !ended) {
      blend(newer[j]);
      march.blending = color.a < opacity_limit;
    }
#endif
    ended = ended || !(march.detecting || march.blending);
  }
  end_block();
  return ended;
}

layout(binding = BIND_DISTANCES) uniform sampler3D distances;  // EmptySpace::distances()
layout(binding = BIND_SPANS) uniform sampler2D spans;          // EmptySpace::spans()

uniform vec2 cell_origin_m, cell_m;   // (x, depth)
uniform vec2 fan_side_1, fan_side_2;  // inward normals over (y, z - axis)
uniform float axis_distance_max_m;    // largest distance of data from the wobble axis
uniform float x_max_m;

// Steps between two tests whether a sampling ray can leap, and the shortest leap that is worth
// refilling the detector for.
const int STEPS_BETWEEN_LEAP_TESTS = 4;
const int MIN_LEAP = REFILL + FIRST_STEP_MULTIPLE + 1;
// Distance in cells from which on a leap is likely to be that long: its length is then computed.
const float MIN_RADIUS = 2.0;
const float MAX_STEPS = 1e6;  // exactly an integer in float

// Clips a span of a ray to the region that can hold data: between the fan's sides, within
// axis_distance_max_m of the wobble axis, within the width of a slice. May be larger by rounding.
vec2 clip_to_field(Ray ray, vec2 span) {
  vec2 origin = vec2(ray.origin.y, ray.origin.z - axis_z_m), direction = ray.direction.yz;
  for (int side = 0; side < 2; ++side) {
    vec2 inward = side == 0 ? fan_side_1 : fan_side_2;
    float height = dot(inward, origin), slope = dot(inward, direction);
    float crossing = -height / slope;
    if (slope > 1e-6) span.x = max(span.x, crossing);
    if (slope < -1e-6) span.y = min(span.y, crossing);
    if (abs(slope) <= 1e-6 && height < -1e-4) span.y = -1.0;
  }
  float a = dot(direction, direction), b = dot(origin, direction);
  float c = dot(origin, origin) - axis_distance_max_m * axis_distance_max_m;
  float root = b * b - a * c;
  if (root < 0.0) {
    if (a > 1e-12 || c > 0.0) span.y = -1.0;
  } else if (a > 1e-12) {
    span = vec2(max(span.x, (-b - sqrt(root)) / a), min(span.y, (-b + sqrt(root)) / a));
  }
  if (abs(ray.direction.x) > 1e-6) {
    float one = (-x_max_m - ray.origin.x) / ray.direction.x;
    float other = (x_max_m - ray.origin.x) / ray.direction.x;
    span = vec2(max(span.x, min(one, other)), min(span.y, max(one, other)));
  }
  return span;
}

vec3 to_cells(vec3 slice) {
  return vec3((slice.xy - cell_origin_m) / cell_m, slice.z);
}

// Distance from a cell to the nearest one that must be sampled; negative outside the grid.
float cells_to_sampled(ivec3 index) {
  ivec3 size = textureSize(distances, 0);
  if (any(lessThan(index, ivec3(0))) || any(greaterThanEqual(index, size))) return -1.0;
  return floor(texelFetch(distances, index, 0).r * 255.0 + 0.5);
}

// Number of steps that a ray can skip from this position, of these slice coordinates; 0: this
// position must be sampled.
int leap_from(Ray ray, vec3 position, vec3 slice) {
  vec3 cell = to_cells(slice);
  ivec3 index = ivec3(floor(cell));
  float radius = cells_to_sampled(index);
  if (radius < 0.0) return 1;
  if (radius == 0.0) return 0;

  // To the border of the block of skippable cells: radius - 1 of them on each side of this one.
  vec3 behind = cell - vec3(index) + (radius - 1.0), ahead = vec3(radius) - (cell - vec3(index));
  vec3 direction = ray.direction;
  float reach = (direction.x > 0.0 ? ahead.x : behind.x) * cell_m.x / max(abs(direction.x), 1e-6);
  // Radially from the wobble axis: no faster than the ray's component in the (y, z) plane.
  vec2 from_axis = vec2(position.y, position.z - axis_z_m);
  float axis_distance_m = length(from_axis), speed = max(length(direction.yz), 1e-6);
  bool outward = dot(from_axis, direction.yz) >= 0.0;
  reach = min(reach, (outward ? ahead.y : min(ahead.y, behind.y)) * cell_m.y / speed);
  // About the wobble axis: the ray's moment is constant, so phi changes fastest at the least
  // distance from the axis.
  float nearest_m = outward ? axis_distance_m
                            : max(axis_distance_m - behind.y * cell_m.y, 1e-3 * axis_distance_m);
  float moment = from_axis.x * direction.z - from_axis.y * direction.y;  // > 0: phi rises
  float frames_per_m = abs(moment * frames_per_rad) / (nearest_m * nearest_m);
#if SKEWED
  frames_per_m += abs(frame_skew) / r_min_m;
  float frames = min(ahead.z, behind.z);
#else
  float frames = moment > 0.0 ? ahead.z : behind.z;
#endif
  reach = min(reach, frames / max(frames_per_m, 1e-6));
  return 1 + int(clamp(reach / step_m - 1e-3, 0.0, MAX_STEPS));
}

int leap_from(March march, int step) {
  float phi;
  vec3 position = sample_position(march, step);
  return leap_from(march.ray, position, slice_coordinates(position, phi));
}

void main() {
  March march;
  int count = begin_pixel(march);
  if (count <= 0) return;
  int next = 0;
#if LEAPS
  vec2 span = texelFetch(spans, ivec2(gl_FragCoord.xy) / TILE, 0).rg;
  span = clip_to_field(march.ray, span) - march.start_m;
  next = int(clamp(span.x / step_m - 1.0, 0.0, MAX_STEPS));
  count = min(count, int(clamp(span.y / step_m + 2.0, 0.0, MAX_STEPS)));
  if (next >= count) return;
#endif
  // Loops test at their begin and again at their end. With the first test alone, llvmpipe runs the
  // body once more for no pixel; with the last alone, what a pixel has when it leaves the loop can
  // change while the pixels beside it go on (Mesa 22.3).
  bool ended = false;
  while (next < count) {
#if LEAPS
    // A separate loop, so that rays that run in parallel leap together and then sample together.
    int leap = 1;
    while (next < count) {
      leap = leap_from(march, next);
      next += leap;
      if (leap == 0 || next >= count) break;
    }
    if (leap > 0) break;
#endif
    // `next` must be sampled: fill kernel and detector from the REFILL steps before, which also
    // establish whether the ray was inside the cone.
    march.was_inside = false;
    int sampled = next, first = max(next - REFILL, 0);
    first -= first % FIRST_STEP_MULTIPLE;
#if BLOCKS
    empty_block(first == 0);
    next = first;
    move_to_block(march, next);
    while (next < count) {
      ended = process_block(march, next, count);
      next += BLOCK;
      bool leaps = false;
#if LEAPS
      float radius = cells_to_sampled(ivec3(floor(to_cells(block_slice))));
      leaps = next > sampled && (radius < 0.0 || radius >= MIN_RADIUS);
#endif
      if (ended || leaps || next >= count) break;
    }
#else
    empty_kernel();
    empty_buffer(first == 0);
    int next_leap_test = next + STEPS_BETWEEN_LEAP_TESTS;
    int front = first - HALF_KERNEL;
    next = count;
    for (; front < count + HALF_KERNEL; ++front) {
      fetch_front(sample_position(march, front), march.across_1, march.across_2);
      int current = front - HALF_KERNEL;
      if (current < first) continue;
      ended = process_sample(march, current);
      if (ended) break;
#if LEAPS
      if (current == next_leap_test) {
        next_leap_test += STEPS_BETWEEN_LEAP_TESTS;
        int steps = leap_from(march, current + 1);
        if (steps >= MIN_LEAP) {
          next = current + 1 + steps;
          break;
        }
      }
#endif
    }
#endif
    if (ended || next >= count) break;
  }
#if BLOCKS && DETECT
  if (!march.detecting) place_surface(march);
#endif
}
