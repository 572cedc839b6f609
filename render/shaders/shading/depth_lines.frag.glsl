// Pass 3, mode fast: the homogeneous filter of z as two one-dimensional passes, rows then columns.
// The intermediate texture holds, per pixel, the sum of z over the row's neighbours that have a
// surface, and their number. textureLod at texel centres: on llvmpipe half the cost of texelFetch.
layout(binding = BIND_DEPTH) uniform sampler2D depth;

// z is summed relative to this distance, near the middle of the relief, to keep float precision.
uniform float middle_m;

#if COLUMNS
layout(binding = BIND_SUMS) uniform sampler2D sums;
layout(location = 0) out float filtered;

void main() {
  vec2 texel = 1.0 / vec2(textureSize(depth, 0));
  vec2 uv = gl_FragCoord.xy * texel;
  vec2 sum = vec2(0.0);
  for (int k = -HALF_FILTER; k <= HALF_FILTER; ++k) {
    float row = uv.y + float(k) * texel.y;
    if (row > 0.0 && row < 1.0) sum += textureLod(sums, vec2(uv.x, row), 0.0).rg;
  }
  float z = textureLod(depth, uv, 0.0).r;
  filtered = z < 0.0 ? z : middle_m + sum.x / sum.y;
}
#else
layout(location = 0) out vec2 sum;

void main() {
  vec2 texel = 1.0 / vec2(textureSize(depth, 0));
  vec2 uv = gl_FragCoord.xy * texel;
  sum = vec2(0.0);
  for (int k = -HALF_FILTER; k <= HALF_FILTER; ++k) {
    float column = uv.x + float(k) * texel.x;
    float z = textureLod(depth, vec2(column, uv.y), 0.0).r;
    if (z >= 0.0 && column > 0.0 && column < 1.0) sum += vec2(z - middle_m, 1.0);
  }
}
#endif
