// Pass 1, mode fast, last of three: the slice filter along columns, divided by the total weight of
// the pixels that hold data (a table, equal for all frames). Writes the four slices as one texel,
// and as three pairs of neighbouring slices, each to a layer of its own.
layout(binding = BIND_ROWS) uniform sampler2DArray rows;
layout(binding = BIND_NORMALISER) uniform sampler2D normaliser;  // 1 / weight; < 0: unfiltered
#if SINGLE_TAP
layout(binding = BIND_PIXELS) uniform sampler2DArray pixels;  // unfiltered
#endif

uniform float weights[TAPS];
uniform float border;  // pixels of `rows` around the target
uniform float group;   // layer of `rows`

layout(location = 0) out vec4 slices;
layout(location = 1) out vec2 first_pair;
layout(location = 2) out vec2 second_pair;
layout(location = 3) out vec2 third_pair;

void main() {
  vec2 size = vec2(textureSize(rows, 0).xy), position = gl_FragCoord.xy + border;
  slices = vec4(0.0);
  for (int tap = 0; tap < TAPS; ++tap) {
    vec2 uv = (position + vec2(0.0, tap - TAPS / 2)) / size;
    slices += weights[tap] * textureLod(rows, vec3(uv, group), 0.0);
  }
  float inverse_weight = textureLod(normaliser, position / size, 0.0).r;
  slices *= inverse_weight;
#if SINGLE_TAP
  if (inverse_weight < 0.0) slices = textureLod(pixels, vec3(position / size, group), 0.0);
#endif
  first_pair = slices.xy;
  second_pair = slices.yz;
  third_pair = slices.zw;
}
