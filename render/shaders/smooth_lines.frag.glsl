// Pass 4, fast: means over a line of the picture, along its rows or its columns. A box filter is
// two such passes, the guided filter four (smooth_guided.frag.glsl says what it does): means of the
// colours and of their squares, from which come the coefficients, and means of those.
// textureLod at texels' middles, as llvmpipe fetches so at half texelFetch's cost.
layout(binding = BIND_PICTURE) uniform sampler2D picture;
layout(binding = BIND_SOURCE) uniform sampler2D source;

uniform float range_sigma;

layout(location = 0) out vec4 result;

// Squares are taken of differences to a middling grey, which keeps more of their digits.
const float GREY = 0.5;

vec4 source_at(vec2 place) {
  vec4 texel = textureLod(source, place, 0.0);
#if STEP == MOMENTS
  texel.rgb -= GREY;
  texel.a = dot(texel.rgb, texel.rgb);
#endif
  return texel;
}

vec4 finished(vec4 mean, vec2 place) {
#if STEP == COEFFICIENTS
  float variance = max(mean.a - dot(mean.rgb, mean.rgb), 0.0);
  float share = variance / (variance + range_sigma * range_sigma);
  return vec4((1.0 - share) * (mean.rgb + GREY), share);
#elif STEP == APPLY
  return vec4(mean.a * textureLod(picture, place, 0.0).rgb + mean.rgb, 1.0);
#else
  return mean;
#endif
}

void main() {
  vec2 texel = 1.0 / vec2(textureSize(source, 0));
  vec2 place = gl_FragCoord.xy * texel;
#if ALONG_COLUMNS
  vec2 along = vec2(0.0, texel.y);
#else
  vec2 along = vec2(texel.x, 0.0);
#endif
  vec4 sum = vec4(0.0);
  float count = 0.0;
  for (int k = -HALF_FILTER; k <= HALF_FILTER; ++k) {
    vec2 neighbour = place + float(k) * along;
    float inside = float(clamp(neighbour, 0.0, 1.0) == neighbour);
    sum += inside * source_at(neighbour);
    count += inside;
  }
  result = finished(sum / count, place);
}
