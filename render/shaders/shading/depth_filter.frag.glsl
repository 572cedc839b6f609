// Pass 3, first half, mode plain: homogeneous filter of z over neighbours that have a surface
// (paper section 3.3).
layout(binding = BIND_DEPTH) uniform sampler2D depth;

layout(location = 0) out float filtered;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  filtered = texelFetch(depth, pixel, 0).r;
  if (filtered < 0.0) return;
  ivec2 last = textureSize(depth, 0) - 1;
  ivec2 low = max(pixel - HALF_FILTER, ivec2(0)), high = min(pixel + HALF_FILTER, last);
  // Summed relative to this pixel's z, to keep float precision.
  float sum = 0.0;
  float count = 0.0;
  for (int row = low.y; row <= high.y; ++row) {
    for (int column = low.x; column <= high.x; ++column) {
      float neighbour = texelFetch(depth, ivec2(column, row), 0).r;
      if (neighbour >= 0.0) {
        sum += neighbour - filtered;
        count += 1.0;
      }
    }
  }
  filtered += sum / count;
}
