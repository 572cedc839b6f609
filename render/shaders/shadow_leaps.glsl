// Pass 3, fast: the samples of shadow_trace.glsl, TILE at a time. Where the nearest surface of the
// tiles that these lie in is no nearer than the ray, none of them can be in shadow, and they are
// leapt over. A ray in front of whatever is left of its way is done.
uniform float shadow_bias_m;

const float FOREVER = 1e30;
const float LONGEST_STEP = 1e3;  // metres, as shadow_trace.glsl has it

// `seen` is a place of the picture, in shares of its side, and a depth.
bool shadowed_at(vec3 seen) {
  float height = textureLod(depth, seen.xy, 0.0).r;
  return height >= 0.0 && height + shadow_bias_m < seen.z;
}

// Tiles overhang the picture where its side is no multiple of theirs.
vec4 tile_at(sampler2D tiles, vec2 place) {
  float tiled = float(textureSize(tiles, 0).x) * float(TILE);
  return textureLod(tiles, place * (image_size / tiled), 0.0);
}

vec3 to_shares(vec3 seen) { return vec3(seen.xy * (1.0 / image_size), seen.z); }

#if PERSPECTIVE

layout(binding = BIND_QUADRANTS) uniform sampler2D quadrants;  // shadow_tiles.frag.glsl
layout(binding = BIND_NEAREST) uniform sampler2D nearest;      // of the whole picture, 1 x 1

// Where the ray leaves the picture through its sides; `ahead` are z, `aside` x or y.
float leaves_at(float aside, float toward, float ahead, float forward) {
  float half_view = 0.5 * image_size * pixel_m / eye_distance_m;
  vec2 gap = vec2(half_view * ahead - aside, half_view * ahead + aside);
  vec2 closing = vec2(toward - half_view * forward, -toward - half_view * forward);
  return min(closing.x > 0.0 ? gap.x / closing.x : FOREVER,
             closing.y > 0.0 ? gap.y / closing.y : FOREVER);
}

bool in_shadow(vec3 place, vec3 to_light, float light_distance) {
  float end = min(light_distance, to_light.z < 0.0 ? -place.z / to_light.z : FOREVER);
  end = min(end, leaves_at(place.x, to_light.x, place.z, to_light.z));
  end = min(end, leaves_at(place.y, to_light.y, place.z, to_light.z));
  float end_depth = length(place + end * to_light);
  // pixels_per_m() is crossing / z^2 all along a ray.
  vec2 speed = (to_light.xy * place.z - place.xy * to_light.z) * (eye_distance_m / pixel_m);
  float crossing = max(abs(speed.x), abs(speed.y));
  // A step of a ray that rises steeply crosses more than its pixel: such rays cannot leap.
  bool leaps = -to_light.z * place.z * float(TILE) <= crossing;
  float never_shadowed = textureLod(nearest, vec2(0.5), 0.0).r + shadow_bias_m;
  float travelled = min(place.z * place.z / crossing, LONGEST_STEP);
  for (int i = 0; i < MAX_SHADOW_STEPS && travelled < end; i += TILE) {
    vec3 here = place + travelled * to_light;
    vec3 seen = to_shares(to_picture(here));
    if (max(seen.z, end_depth) <= never_shadowed) return false;
    float next = travelled;
    for (int k = 0; k < TILE; ++k) {
      float ahead = place.z + next * to_light.z;
      next += min(ahead * ahead / crossing, LONGEST_STEP);
    }
    float deepest = max(seen.z, length(place + min(next, end) * to_light));
    float clear = quadrant(tile_at(quadrants, seen.xy), greaterThan(speed, vec2(0.0)));
    bool leap = leaps && deepest <= clear + shadow_bias_m;
    float stop = leap ? travelled : min(next, end);
    while (travelled < stop) {
      here = place + travelled * to_light;
      if (shadowed_at(to_shares(to_picture(here)))) return true;
      travelled += min(here.z * here.z / crossing, LONGEST_STEP);
    }
    travelled = next;
  }
  return false;
}

#else

layout(binding = BIND_CLEAR) uniform sampler2D clear_depths;  // shadow_clear.frag.glsl

// How many steps lead out of the picture through its sides.
float leaves_at(float place, float stride) {
  return stride > 0.0 ? (1.0 - place) / stride : stride < 0.0 ? -place / stride : FOREVER;
}

bool in_shadow(vec3 place, vec3 to_light, float light_distance) {
  float step_m = 1.0 / max(pixels_per_m(place, to_light), 1.0 / LONGEST_STEP);
  vec3 from = to_shares(to_picture(place));
  vec3 stride = to_shares(step_m * vec3(to_light.xy / pixel_m, to_light.z));
  float end = min(light_distance / step_m, stride.z < 0.0 ? -from.z / stride.z : FOREVER);
  end = min(end, min(leaves_at(from.x, stride.x), leaves_at(from.y, stride.y)));
  float travelled = 1.0;
  while (travelled < end) {
    vec3 seen = from + travelled * stride;
    vec2 clear = tile_at(clear_depths, seen.xy).xy;
    float next = travelled + float(TILE);
    if (seen.z <= clear.y) end = min(end, next);
    next = min(next, end);
    bool leap = max(seen.z, from.z + next * stride.z) <= clear.x;
    for (float k = leap ? next : travelled; k < next; k += 1.0) {
      if (shadowed_at(from + k * stride)) return true;
    }
    travelled = next;
  }
  return false;
}

#endif
