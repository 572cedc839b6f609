// Pass 2, mode fast: as mode plain, but a ray leaps over what it can find nothing in.
layout(binding = BIND_DISTANCES) uniform sampler3D distances;  // see render/leaping/skippable_cells.h

uniform vec2 cell_origin_m, cell_m;   // (x, depth)
uniform vec2 fan_side_1, fan_side_2;  // of (y, z - axis): >= 0 between the fan's sides
uniform float arm_max_m;              // farthest from the wobble axis
uniform float x_max_m;

// Steps between looks at whether a sampled ray may leap again, and the shortest leap that is worth
// filling the buffer anew for.
const int STEPS_BETWEEN_LOOKS = 4;
const int SHORTEST_LEAP = BUFFER + 2;
const float MOST_STEPS = 1e6;  // a whole number still, in any arithmetic

// Part of a ray within all that can hold data: between the fan's sides, within reach of the wobble
// axis, within the width of a slice. Generous by rounding.
vec2 clip_to_field(Ray ray, vec2 span) {
  vec2 place = vec2(ray.origin.y, ray.origin.z - axis_z_m), move = ray.direction.yz;
  for (int side = 0; side < 2; ++side) {
    vec2 inward = side == 0 ? fan_side_1 : fan_side_2;
    float height = dot(inward, place), slope = dot(inward, move);
    float crossing = -height / slope;
    if (slope > 1e-6) span.x = max(span.x, crossing);
    if (slope < -1e-6) span.y = min(span.y, crossing);
    if (abs(slope) <= 1e-6 && height < -1e-4) span.y = -1.0;
  }
  float a = dot(move, move), b = dot(place, move), c = dot(place, place) - arm_max_m * arm_max_m;
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

// How many steps a ray may go on from this place without looking; 0: this place must be sampled.
int leap_from(Ray ray, vec3 place) {
  bool inside_cone;
  vec3 at = slice_place(place, inside_cone);
  vec3 cell = vec3((at.xy - cell_origin_m) / cell_m, at.z);
  ivec3 whole = ivec3(floor(cell)), size = textureSize(distances, 0);
  if (any(lessThan(whole, ivec3(0))) || any(greaterThanEqual(whole, size))) return 1;
  float radius = floor(texelFetch(distances, whole, 0).r * 255.0 + 0.5);
  if (radius == 0.0) return 0;

  // To the end of the block of cells that is known: radius - 1 of them on each side of this one.
  vec3 behind = cell - vec3(whole) + (radius - 1.0), ahead = vec3(radius) - (cell - vec3(whole));
  vec3 direction = ray.direction;
  float reach = (direction.x > 0.0 ? ahead.x : behind.x) * cell_m.x / max(abs(direction.x), 1e-6);
  // Towards the wobble axis or away from it: no faster than the ray's part in that plane.
  vec2 arm = vec2(place.y, place.z - axis_z_m);
  float arm_m = length(arm), speed = max(length(direction.yz), 1e-6);
  bool away = dot(arm, direction.yz) >= 0.0;
  reach = min(reach, (away ? ahead.y : min(ahead.y, behind.y)) * cell_m.y / speed);
  // About the axis: the ray's moment is the same all along, so it turns fastest where nearest.
  float nearest_m = away ? arm_m : max(arm_m - behind.y * cell_m.y, 1e-3 * arm_m);
  float moment = arm.x * direction.z - arm.y * direction.y;  // > 0: phi rises
  float frames_per_m = abs(moment * frames_per_rad) / (nearest_m * nearest_m);
#if SKEWED
  frames_per_m += abs(frame_skew) / r_min_m;
  float frames = min(ahead.z, behind.z);
#else
  float frames = moment > 0.0 ? ahead.z : behind.z;
#endif
  reach = min(reach, frames / max(frames_per_m, 1e-6));
  return 1 + int(clamp(reach / step_m - 1e-3, 0.0, MOST_STEPS));
}

void main() {
  March march;
  int count = begin_pixel(march);
  if (count <= 0) return;
  int next = 0;
#if LEAPS
  vec2 field = clip_to_field(march.ray, vec2(0.0, 1e30)) - march.start_m;
  next = int(clamp(field.x / step_m - 1.0, 0.0, MOST_STEPS));
  count = min(count, int(clamp(field.y / step_m + 2.0, 0.0, MOST_STEPS)));
#endif
  bool ended = false;
  while (next < count && !ended) {
#if LEAPS
    // A loop of its own, so that rays that are computed side by side leap at the same time, and
    // then sample at the same time.
    int leap = 1;
    while (leap > 0 && next < count) {
      leap = leap_from(march.ray, place_of(march, next));
      next += leap;
    }
    if (leap > 0) break;
#endif
    // Something may be here: fill kernel and buffer from the steps before. They tell, too, whether
    // the ray was inside the cone.
    march.was_inside = false;
    int first = max(next - BUFFER, 0);
#if BLOCKS
    empty_block();
    for (int begin = first; begin < count && !ended; begin += BUFFER) {
      ended = look_at_block(march, begin, count);
      next = begin + BUFFER;
#if LEAPS
      int leap_on = leap_from(march.ray, place_of(march, next));
      if (leap_on >= SHORTEST_LEAP) {
        next += leap_on;
        break;
      }
#endif
    }
#else
    empty_kernel();
    empty_buffer();
    int look_again = next + STEPS_BETWEEN_LOOKS;
    int front = first - HALF_KERNEL;
    next = count;
    for (; front < count + HALF_KERNEL; ++front) {
      fetch_front(place_of(march, front), march.across_1, march.across_2);
      int current = front - HALF_KERNEL;
      if (current < first) continue;
      ended = look(march, current);
      if (ended) break;
#if LEAPS
      if (current == look_again) {
        look_again += STEPS_BETWEEN_LOOKS;
        int steps = leap_from(march.ray, place_of(march, current + 1));
        if (steps >= SHORTEST_LEAP) {
          next = current + 1 + steps;
          break;
        }
      }
#endif
    }
#endif
  }
}
