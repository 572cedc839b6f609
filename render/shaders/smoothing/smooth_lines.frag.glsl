// Pass 4, mode fast: means along rows or columns. The box filter is two such passes, the guided
// filter (smooth_guided.frag.glsl) four: means of the colours and of their squares give the
// coefficients, which are averaged in turn. textureLod at texel centres: on llvmpipe half the cost
// of texelFetch.
layout(binding = BIND_PICTURE) uniform sampler2D picture;
layout(binding = BIND_SOURCE) uniform sampler2D source;

uniform float range_sigma;

layout(location = 0) out vec4 result;

// Squares are taken of differences to a medium grey, to keep float precision.
const float GREY = 0.5;

vec4 source_at(vec2 uv) {
  vec4 texel = textureLod(source, uv, 0.0);
#if STEP == MOMENTS
  texel.rgb -= GREY;
  texel.a = dot(texel.rgb, texel.rgb);
#endif
  return texel;
}

vec4 finish(vec4 mean, vec2 uv) {
#if STEP == COEFFICIENTS
  float variance = max(mean.a - dot(mean.rgb, mean.rgb), 0.0);
  float scale = variance / (variance + range_sigma * range_sigma);
  return vec4((1.0 - scale) * (mean.rgb + GREY), scale);
#elif STEP == APPLY
  return vec4(mean.a * textureLod(picture, uv, 0.0).rgb + mean.rgb, 1.0);
#else
  return mean;
#endif
}

void main() {
  vec2 texel = 1.0 / vec2(textureSize(source, 0));
  vec2 uv = gl_FragCoord.xy * texel;
#if ALONG_COLUMNS
  vec2 along = vec2(0.0, texel.y);
#else
  vec2 along = vec2(texel.x, 0.0);
#endif
  vec4 sum = vec4(0.0);
  float count = 0.0;
  for (int k = -HALF_FILTER; k <= HALF_FILTER; ++k) {
    vec2 neighbour = uv + float(k) * along;
    float inside = float(clamp(neighbour, 0.0, 1.0) == neighbour);
    sum += inside * source_at(neighbour);
    count += inside;
  }
  result = finish(sum / count, uv);
}
