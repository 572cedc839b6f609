// Pass 4, fast: the bilateral filter of smooth.frag.glsl with its weights as powers of two, and
// textureLod at texels' middles, as llvmpipe fetches so at half texelFetch's cost.
layout(binding = BIND_PICTURE) uniform sampler2D picture;

// -log2 of a weight for a unit of contrast squared, and for a pixel of distance squared.
uniform float range_bits;
uniform float spatial_bits;

layout(location = 0) out vec4 smoothed;

const float NO_WEIGHT = 1e3;  // in bits

float bits(int offset, float place) {
  return place > 0.0 && place < 1.0 ? spatial_bits * float(offset * offset) : NO_WEIGHT;
}

void main() {
  vec2 texel = 1.0 / vec2(textureSize(picture, 0));
  vec2 place = gl_FragCoord.xy * texel;
  vec3 center = textureLod(picture, place, 0.0).rgb;
  vec3 sum = vec3(0.0);
  float total = 0.0;
  for (int j = -HALF_FILTER; j <= HALF_FILTER; ++j) {
    float row = place.y + float(j) * texel.y, row_bits = bits(j, row);
    for (int i = -HALF_FILTER; i <= HALF_FILTER; ++i) {
      float column = place.x + float(i) * texel.x;
      vec3 change = textureLod(picture, vec2(column, row), 0.0).rgb - center;
      float weight = exp2(-(row_bits + bits(i, column) + range_bits * dot(change, change)));
      sum += weight * change;
      total += weight;
    }
  }
  smoothed = vec4(center + sum / total, 1.0);
}
