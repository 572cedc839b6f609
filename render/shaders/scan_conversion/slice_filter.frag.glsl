// Pass 1, second half, mode plain: weighted mean over the pixels of the slice that hold data.
// Pixels next to the sector take the mean of their neighbours in it, so that linear fetches at the
// border read data only.
layout(binding = BIND_SLICE) uniform sampler2D slice;

uniform float weights[TAPS];

layout(location = 0) out float value;

const int HALF_FILTER = TAPS / 2;

float weight_at(ivec2 offset) {
#if BOX
  return 1.0;
#else
  return weights[offset.x + HALF_FILTER] * weights[offset.y + HALF_FILTER];
#endif
}

float mean_around(ivec2 pixel, int half_size) {
  ivec2 last = textureSize(slice, 0) - 1;
  ivec2 low = max(pixel - half_size, ivec2(0)), high = min(pixel + half_size, last);
  float sum = 0.0;
  float total = 0.0;
  for (int row = low.y; row <= high.y; ++row) {
    for (int column = low.x; column <= high.x; ++column) {
      float neighbour = texelFetch(slice, ivec2(column, row), 0).r;
      if (neighbour >= 0.0) {
        float weight = weight_at(ivec2(column, row) - pixel);
        sum += weight * neighbour;
        total += weight;
      }
    }
  }
  return total > 0.0 ? sum / total : 0.0;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  bool is_empty = texelFetch(slice, pixel, 0).r < 0.0;
  value = mean_around(pixel, is_empty ? max(HALF_FILTER, 1) : HALF_FILTER);
}
