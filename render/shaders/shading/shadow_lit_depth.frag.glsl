// Pass 3, mode fast, parallel projection: for the rays to the light that pass a tile of the
// picture, the largest depth at which they are lit in their next TILE samples (x) and in all
// samples after those (y); FOREVER if none is in shadow, -1 if any may be. For y the rays of the
// tile are traced together, TILE pixels at a time: after the same fraction of their paths to the
// light they lie within half a tile of the central ray.
layout(binding = BIND_QUADRANTS) uniform sampler2D quadrants;  // shadow_tiles.frag.glsl
layout(binding = BIND_WIDE_QUADRANTS) uniform sampler2D wide_quadrants;
layout(binding = BIND_NEAREST) uniform sampler2D nearest;  // minimum z of the picture, 1 x 1

uniform vec3 light_position_m;
uniform vec3 light_direction;
uniform float shadow_bias_m;

layout(location = 0) out vec2 lit_depths;

const float FOREVER = 1e30;
const float SIDE = float(TILE);

#if POINT_LIGHT

// In pixels of the picture.
vec2 path_to_light(vec2 middle) { return to_picture(light_position_m).xy - middle; }

// Depth in the tile of a ray that has the depth `depth` after `travelled` of `path` pixels.
float start_depth(float depth, float travelled, float path) {
  float fraction = travelled / path;
  if (fraction >= 1.0) return light_position_m.z <= depth ? FOREVER : -1.0;
  return (depth - fraction * light_position_m.z) / (1.0 - fraction);
}

// A tile's pixels are up to half a tile farther from the light than its middle.
float first_travelled(float path) { return (SIDE + 1.0) * path / (path + 0.5 * SIDE); }
bool rises_above(float depth) { return light_position_m.z < depth; }

#else

// In pixels of the picture, long enough to leave it from any tile.
vec2 path_to_light(vec2 middle) {
  vec2 along = abs(light_direction.xy);
  return light_direction.xy * (4.0 * image_size / max(max(along.x, along.y), 1e-6));
}

float start_depth(float depth, float travelled, float path) {
  float speed = max(pixels_per_m(vec3(0.0), light_direction), 1e-3);
  return depth - travelled * light_direction.z / speed;
}

float first_travelled(float path) { return SIDE + 1.0; }
bool rises_above(float depth) { return true; }

#endif

void main() {
  vec2 middle = gl_FragCoord.xy * SIDE;
  vec2 path = path_to_light(middle);
  float length = max(abs(path.x), abs(path.y));
  vec2 stride = path / max(length, 1.0);
  bvec2 positive = greaterThan(stride, vec2(0.0));
  vec2 behind = mix(vec2(0.5), vec2(-0.5), positive) * SIDE;
  float always_lit_depth = textureLod(nearest, vec2(0.5), 0.0).r + shadow_bias_m;
  float lit_depth = FOREVER;
  for (float travelled = first_travelled(length); travelled < length; travelled += SIDE) {
    if (rises_above(always_lit_depth) &&
        start_depth(always_lit_depth, travelled, length) >= lit_depth) {
      break;
    }
    vec2 pixel = middle + travelled * stride;
    if (any(lessThan(pixel, vec2(-SIDE))) || any(greaterThan(pixel, vec2(image_size + SIDE)))) {
      break;
    }
    vec2 uv = (pixel + behind) / (vec2(textureSize(wide_quadrants, 0)) * SIDE);
    float depth = quadrant(textureLod(wide_quadrants, uv, 0.0), positive) + shadow_bias_m;
    lit_depth = min(lit_depth, min(start_depth(depth, travelled, length),
                                   start_depth(depth, travelled + SIDE, length)));
  }
  // If the light is above the tile's own rows or columns, its rays stay within those, which belong
  // to either quadrant.
  vec4 ahead = texelFetch(quadrants, ivec2(gl_FragCoord.xy), 0);
  lit_depths = vec2(quadrant(ahead, positive) + shadow_bias_m, lit_depth);
}
