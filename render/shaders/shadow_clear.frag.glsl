// Pass 3, fast, parallel projection: for rays to the light in a tile of the picture, how deep they
// may be and be lit, in their next TILE samples (x) and in all samples after those (y). For the
// latter all the tile's rays are followed at once, TILE pixels at a time: the same share of the way
// to the light along, they lie within half a tile of the middle's ray. FOREVER where none is in
// shadow, -1 where any may be.
layout(binding = BIND_QUADRANTS) uniform sampler2D quadrants;  // shadow_tiles.frag.glsl
layout(binding = BIND_WIDE_QUADRANTS) uniform sampler2D wide_quadrants;
layout(binding = BIND_NEAREST) uniform sampler2D nearest;

uniform vec3 light_position_m;
uniform vec3 light_direction;
uniform float shadow_bias_m;

layout(location = 0) out vec2 clear_depths;

const float FOREVER = 1e30;
const float SIDE = float(TILE);

#if POINT_LIGHT

vec2 way_to_light(vec2 middle) { return to_picture(light_position_m).xy - middle; }

// z on the tile from where a ray is at depth `seen` after `gone` of `way` pixels.
float start_depth(float seen, float gone, float way) {
  float share = gone / way;
  if (share >= 1.0) return light_position_m.z <= seen ? FOREVER : -1.0;
  return (seen - share * light_position_m.z) / (1.0 - share);
}

// A tile's pixels are up to half a tile further from the light than its middle.
float first_gone(float way) { return (SIDE + 1.0) * way / (way + 0.5 * SIDE); }
bool rises_above(float seen) { return light_position_m.z < seen; }

#else

// In pixels, long enough to leave the picture from anywhere.
vec2 way_to_light(vec2 middle) {
  vec2 along = abs(light_direction.xy);
  return light_direction.xy * (4.0 * image_size / max(max(along.x, along.y), 1e-6));
}

float start_depth(float seen, float gone, float way) {
  float speed = max(pixels_per_m(vec3(0.0), light_direction), 1e-3);
  return seen - gone * light_direction.z / speed;
}

float first_gone(float way) { return SIDE + 1.0; }
bool rises_above(float seen) { return true; }

#endif

void main() {
  vec2 middle = gl_FragCoord.xy * SIDE;
  vec2 way = way_to_light(middle);
  float length = max(abs(way.x), abs(way.y));
  vec2 stride = way / max(length, 1.0);
  bvec2 positive = greaterThan(stride, vec2(0.0));
  vec2 behind = mix(vec2(0.5), vec2(-0.5), positive) * SIDE;
  float never_shadowed = textureLod(nearest, vec2(0.5), 0.0).r + shadow_bias_m;
  float clear_depth = FOREVER;
  for (float gone = first_gone(length); gone < length; gone += SIDE) {
    if (rises_above(never_shadowed) && start_depth(never_shadowed, gone, length) >= clear_depth) {
      break;
    }
    vec2 at = middle + gone * stride;
    if (any(lessThan(at, vec2(-SIDE))) || any(greaterThan(at, vec2(image_size + SIDE)))) break;
    vec2 place = (at + behind) / (vec2(textureSize(wide_quadrants, 0)) * SIDE);
    float seen = quadrant(textureLod(wide_quadrants, place, 0.0), positive) + shadow_bias_m;
    clear_depth = min(clear_depth, min(start_depth(seen, gone, length),
                                       start_depth(seen, gone + SIDE, length)));
  }
  // Where the light is over the tile's own rows or columns, its rays stay within those: whichever
  // quadrant holds them.
  vec4 ahead = texelFetch(quadrants, ivec2(gl_FragCoord.xy), 0);
  clear_depths = vec2(quadrant(ahead, positive) + shadow_bias_m, clear_depth);
}
