// Pass 1, mode fast, second of three: the slice filter along rows, as weighted sums; pixels without
// data are 0. Four slices at once, as in scan_convert_layers.frag.glsl.
layout(binding = BIND_PIXELS) uniform sampler2DArray pixels;

uniform float weights[TAPS];

flat in int source_layer;

layout(location = 0) out vec4 sums;

void main() {
  vec2 size = vec2(textureSize(pixels, 0).xy);
  sums = vec4(0.0);
  for (int tap = 0; tap < TAPS; ++tap) {
    vec2 uv = (gl_FragCoord.xy + vec2(tap - TAPS / 2, 0.0)) / size;
    sums += weights[tap] * textureLod(pixels, vec3(uv, float(source_layer)), 0.0);
  }
}
