// Pass 4, mode plain: homogeneous or bilateral filter of the shaded picture (paper section 3.4).
layout(binding = BIND_PICTURE) uniform sampler2D picture;

uniform float range_sigma;
uniform float spatial_sigma;

layout(location = 0) out vec4 smoothed;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(picture, 0) - 1;
  ivec2 low = max(pixel - HALF_FILTER, ivec2(0)), high = min(pixel + HALF_FILTER, last);
  vec3 center = texelFetch(picture, pixel, 0).rgb;
  vec3 sum = vec3(0.0);
  float total = 0.0;
  for (int row = low.y; row <= high.y; ++row) {
    for (int column = low.x; column <= high.x; ++column) {
      vec3 change = texelFetch(picture, ivec2(column, row), 0).rgb - center;
#if BILATERAL
      vec2 offset = vec2(ivec2(column, row) - pixel) / spatial_sigma;
      vec3 contrast = change / range_sigma;
      float weight = exp(-0.5 * (dot(offset, offset) + dot(contrast, contrast)));
#else
      float weight = 1.0;
#endif
      sum += weight * change;
      total += weight;
    }
  }
  smoothed = vec4(center + sum / total, 1.0);
}
