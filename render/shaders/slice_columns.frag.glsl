// Pass 1, mode fast, last of three: sums along columns of the sums along rows, divided by the weight
// of the pixels that hold data, which is the same for every frame and comes as a table. Four slices
// become three pairs of neighbours, each for a layer of its own, and stay together besides.
layout(binding = BIND_ROWS) uniform sampler2DArray rows;
layout(binding = BIND_NORMALISER) uniform sampler2D normaliser;  // negative: leave the pixel alone
#if LONE_TAP
layout(binding = BIND_PIXELS) uniform sampler2DArray pixels;  // before any sum
#endif

uniform float weights[TAPS];
uniform float border;  // pixels of `rows` around the target
uniform float group;   // layer of `rows`

layout(location = 0) out vec4 slices;
layout(location = 1) out vec2 first_pair;
layout(location = 2) out vec2 second_pair;
layout(location = 3) out vec2 third_pair;

void main() {
  vec2 size = vec2(textureSize(rows, 0).xy), place = gl_FragCoord.xy + border;
  slices = vec4(0.0);
  for (int tap = 0; tap < TAPS; ++tap) {
    vec2 at = (place + vec2(0.0, tap - TAPS / 2)) / size;
    slices += weights[tap] * textureLod(rows, vec3(at, group), 0.0);
  }
  float over_weight = textureLod(normaliser, place / size, 0.0).r;
  slices *= over_weight;
#if LONE_TAP
  if (over_weight < 0.0) slices = textureLod(pixels, vec3(place / size, group), 0.0);
#endif
  first_pair = slices.xy;
  second_pair = slices.yz;
  third_pair = slices.zw;
}
