// Pass 3, fast: the homogeneous filter of z as two passes of one dimension, rows and then columns.
// In between are, for each pixel, the sum of z over its row's neighbours that have a surface, and
// their number. textureLod at texels' middles, as llvmpipe fetches so at half texelFetch's cost.
layout(binding = BIND_DEPTH) uniform sampler2D depth;

// What z is summed relative to: a distance in the middle of the relief keeps the digits that z
// itself would lose.
uniform float middle_m;

#if COLUMNS
layout(binding = BIND_SUMS) uniform sampler2D sums;
layout(location = 0) out float filtered;

void main() {
  vec2 texel = 1.0 / vec2(textureSize(depth, 0));
  vec2 place = gl_FragCoord.xy * texel;
  vec2 sum = vec2(0.0);
  for (int k = -HALF_FILTER; k <= HALF_FILTER; ++k) {
    float row = place.y + float(k) * texel.y;
    if (row > 0.0 && row < 1.0) sum += textureLod(sums, vec2(place.x, row), 0.0).rg;
  }
  float z = textureLod(depth, place, 0.0).r;
  filtered = z < 0.0 ? z : middle_m + sum.x / sum.y;
}
#else
layout(location = 0) out vec2 sum;

void main() {
  vec2 texel = 1.0 / vec2(textureSize(depth, 0));
  vec2 place = gl_FragCoord.xy * texel;
  sum = vec2(0.0);
  for (int k = -HALF_FILTER; k <= HALF_FILTER; ++k) {
    float column = place.x + float(k) * texel.x;
    float z = textureLod(depth, vec2(column, place.y), 0.0).r;
    if (z >= 0.0 && column > 0.0 && column < 1.0) sum += vec2(z - middle_m, 1.0);
  }
}
#endif
