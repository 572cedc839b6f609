// Pass 3, shared: access to the filtered z-buffer, and cast shadows.
layout(binding = BIND_DEPTH) uniform sampler2D depth;

// z of a pixel in metres; negative without a surface or outside the picture.
float depth_at(ivec2 pixel) {
  ivec2 size = textureSize(depth, 0);
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) return NO_SURFACE;
#if FAST
  return textureLod(depth, (vec2(pixel) + 0.5) / vec2(size), 0.0).r;
#else
  return texelFetch(depth, pixel, 0).r;
#endif
}

uniform float shadow_bias_m;

#if !FAST

// Traces from each pixel towards the light through the height map, one pixel of the picture per
// step (paper section 3.3, Fig. 4).
// Whether the height map occludes the light.
bool in_shadow(vec3 position, vec3 to_light, float light_distance) {
  float travelled = 0.0;
  for (int i = 0; i < MAX_SHADOW_STEPS; ++i) {
    vec3 here = position + travelled * to_light;
    travelled += 1.0 / max(pixels_per_m(here, to_light), 1e-3);
    if (travelled >= light_distance) return false;
    here = position + travelled * to_light;
    if (here.z <= 0.0) return false;  // in front of the view plane, or behind the eye
    vec3 projected = to_picture(here);
    if (any(lessThan(projected.xy, vec2(0.0))) ||
        any(greaterThanEqual(projected.xy, vec2(image_size)))) {
      return false;
    }
    float height = depth_at(ivec2(projected.xy));
    if (height >= 0.0 && height + shadow_bias_m < projected.z) return true;
  }
  return false;
}

#else

// Takes the samples of mode plain, TILE at a time. If no surface in the tiles of these samples is
// nearer than the ray, none of them is in shadow and they are skipped. The trace ends when no
// surface ahead can be nearer than the ray.
const float FOREVER = 1e30;
const float LONGEST_STEP = 1e3;  // metres, as in mode plain

// `projected`: picture coordinates as fractions of the picture's side (xy), depth in metres (z).
bool shadowed_at(vec3 projected) {
  float height = textureLod(depth, projected.xy, 0.0).r;
  return height >= 0.0 && height + shadow_bias_m < projected.z;
}

// The tiles extend beyond the picture if its side is not a multiple of theirs.
vec4 tile_at(sampler2D tiles, vec2 uv) {
  float tiled = float(textureSize(tiles, 0).x) * float(TILE);
  return textureLod(tiles, uv * (image_size / tiled), 0.0);
}

vec3 to_fractions(vec3 projected) { return vec3(projected.xy * (1.0 / image_size), projected.z); }

#if PERSPECTIVE

layout(binding = BIND_QUADRANTS) uniform sampler2D quadrants;  // shadow_tiles.frag.glsl
layout(binding = BIND_NEAREST) uniform sampler2D nearest;      // minimum z of the picture, 1 x 1

// Ray length at which a ray leaves the picture sideways; `ahead` is z, `aside` x or y of its
// origin, `forward` and `toward` are the components of its direction.
float leaves_at(float aside, float toward, float ahead, float forward) {
  float half_view = 0.5 * image_size * pixel_m / eye_distance_m;
  vec2 gap = vec2(half_view * ahead - aside, half_view * ahead + aside);
  vec2 closing = vec2(toward - half_view * forward, -toward - half_view * forward);
  return min(closing.x > 0.0 ? gap.x / closing.x : FOREVER,
             closing.y > 0.0 ? gap.y / closing.y : FOREVER);
}

bool in_shadow(vec3 position, vec3 to_light, float light_distance) {
  float end = min(light_distance, to_light.z < 0.0 ? -position.z / to_light.z : FOREVER);
  end = min(end, leaves_at(position.x, to_light.x, position.z, to_light.z));
  end = min(end, leaves_at(position.y, to_light.y, position.z, to_light.z));
  float end_depth = length(position + end * to_light);
  // pixels_per_m() equals crossing / z^2 along the whole ray.
  vec2 speed = (to_light.xy * position.z - position.xy * to_light.z) * (eye_distance_m / pixel_m);
  float crossing = max(abs(speed.x), abs(speed.y));
  // On a steeply rising ray a step crosses more than one pixel: such rays cannot leap.
  bool leaps = -to_light.z * position.z * float(TILE) <= crossing;
  float always_lit_depth = textureLod(nearest, vec2(0.5), 0.0).r + shadow_bias_m;
  float travelled = min(position.z * position.z / crossing, LONGEST_STEP);
  for (int i = 0; i < MAX_SHADOW_STEPS && travelled < end; i += TILE) {
    vec3 here = position + travelled * to_light;
    vec3 projected = to_fractions(to_picture(here));
    if (max(projected.z, end_depth) <= always_lit_depth) return false;
    float next = travelled;
    for (int k = 0; k < TILE; ++k) {
      float ahead = position.z + next * to_light.z;
      next += min(ahead * ahead / crossing, LONGEST_STEP);
    }
    float deepest = max(projected.z, length(position + min(next, end) * to_light));
    float nearest_m = quadrant(tile_at(quadrants, projected.xy), greaterThan(speed, vec2(0.0)));
    bool leap = leaps && deepest <= nearest_m + shadow_bias_m;
    float stop = leap ? travelled : min(next, end);
    while (travelled < stop) {
      here = position + travelled * to_light;
      if (shadowed_at(to_fractions(to_picture(here)))) return true;
      travelled += min(here.z * here.z / crossing, LONGEST_STEP);
    }
    travelled = next;
  }
  return false;
}

#else

layout(binding = BIND_LIT_DEPTH) uniform sampler2D lit_depths;  // shadow_lit_depth.frag.glsl

// Number of steps after which a ray leaves the picture sideways.
float leaves_at(float start, float stride) {
  return stride > 0.0 ? (1.0 - start) / stride : stride < 0.0 ? -start / stride : FOREVER;
}

bool in_shadow(vec3 position, vec3 to_light, float light_distance) {
  float step_m = 1.0 / max(pixels_per_m(position, to_light), 1.0 / LONGEST_STEP);
  vec3 from = to_fractions(to_picture(position));
  vec3 stride = to_fractions(step_m * vec3(to_light.xy / pixel_m, to_light.z));
  float end = min(light_distance / step_m, stride.z < 0.0 ? -from.z / stride.z : FOREVER);
  end = min(end, min(leaves_at(from.x, stride.x), leaves_at(from.y, stride.y)));
  float travelled = 1.0;
  while (travelled < end) {
    vec3 projected = from + travelled * stride;
    vec2 lit_depth = tile_at(lit_depths, projected.xy).xy;
    float next = travelled + float(TILE);
    if (projected.z <= lit_depth.y) end = min(end, next);
    next = min(next, end);
    bool leap = max(projected.z, from.z + next * stride.z) <= lit_depth.x;
    for (float k = leap ? next : travelled; k < next; k += 1.0) {
      if (shadowed_at(from + k * stride)) return true;
    }
    travelled = next;
  }
  return false;
}

#endif

#endif
