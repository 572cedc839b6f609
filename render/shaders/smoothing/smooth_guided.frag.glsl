// Pass 4, mode plain: the self-guided filter (He et al. 2013) of the shaded picture. Each window
// maps a colour to scale * colour + offset; a pixel takes the mean over the windows that contain
// it. One scale for the three channels, variance / (variance + range_sigma^2) with the sum of their
// variances: an edge of any colour is kept in all channels, and no hue is shifted.
layout(binding = BIND_PICTURE) uniform sampler2D picture;

layout(location = 0) out vec4 result;

#if STEP == COEFFICIENTS
uniform float range_sigma;
#else
layout(binding = BIND_SOURCE) uniform sampler2D coefficients;  // RGB: offset, A: scale
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(picture, 0) - 1;
  ivec2 low = max(pixel - HALF_FILTER, ivec2(0)), high = min(pixel + HALF_FILTER, last);
  vec3 center = texelFetch(picture, pixel, 0).rgb;
  float count = float((high.x - low.x + 1) * (high.y - low.y + 1));
  vec4 sum = vec4(0.0);
  for (int row = low.y; row <= high.y; ++row) {
    for (int column = low.x; column <= high.x; ++column) {
#if STEP == COEFFICIENTS
      vec3 change = texelFetch(picture, ivec2(column, row), 0).rgb - center;
      sum += vec4(change, dot(change, change));
#else
      sum += texelFetch(coefficients, ivec2(column, row), 0);
#endif
    }
  }
  vec4 mean = sum / count;
#if STEP == COEFFICIENTS
  float variance = max(mean.a - dot(mean.rgb, mean.rgb), 0.0);
  float scale = variance / (variance + range_sigma * range_sigma);
  result = vec4((1.0 - scale) * (center + mean.rgb), scale);
#else
  result = vec4(mean.a * center + mean.rgb, 1.0);
#endif
}
