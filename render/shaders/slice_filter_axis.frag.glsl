// Pass 1, mode fast, second half, one axis at a time: sums along rows, then along columns, of
// pixels that are 0 where there is no data. The second sum is divided by the weight of the pixels
// that hold data, which is the same for every frame and comes as a table.
layout(binding = BIND_PIXELS) uniform sampler2DArray pixels;  // red, green: a pair of slices
#if LAST_AXIS
layout(binding = BIND_NORMALISER) uniform sampler2D normaliser;  // negative: leave the pixel alone
#endif

uniform float weights[TAPS];
uniform vec2 border;  // of `pixels` around the target

flat in int source_layer;

// With a lone tap, along rows: the pixel itself besides, in blue and alpha.
layout(location = 0) out vec4 pair;

void main() {
  vec2 size = vec2(textureSize(pixels, 0).xy);
  vec2 place = gl_FragCoord.xy + border;
  float layer = float(source_layer);
#if LAST_AXIS
  const vec2 axis = vec2(0.0, 1.0);
#else
  const vec2 axis = vec2(1.0, 0.0);
#endif
  vec2 sum = vec2(0.0);
  for (int tap = 0; tap < TAPS; ++tap) {
    vec2 at = place + float(tap - TAPS / 2) * axis;
    sum += weights[tap] * textureLod(pixels, vec3(at / size, layer), 0.0).rg;
  }
#if LAST_AXIS
  float over_weight = textureLod(normaliser, place / size, 0.0).r;
  pair.rg = sum * over_weight;
#if LONE_TAP
  if (over_weight < 0.0) pair.rg = textureLod(pixels, vec3(place / size, layer), 0.0).ba;
#endif
#elif LONE_TAP
  pair = vec4(sum, textureLod(pixels, vec3(place / size, layer), 0.0).rg);
#else
  pair.rg = sum;
#endif
}
