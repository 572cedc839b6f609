// Pass 4, mode fast: the bilateral filter of smooth.frag.glsl with weights as powers of two.
// textureLod at texel centres: on llvmpipe half the cost of texelFetch.
layout(binding = BIND_PICTURE) uniform sampler2D picture;

// -log2 of the weight per unit of contrast squared and per pixel of distance squared.
uniform float range_bits;
uniform float spatial_bits;

layout(location = 0) out vec4 smoothed;

const float NO_WEIGHT = 1e3;  // in bits

// `u`: a texture coordinate; outside the picture the weight vanishes.
float bits(int offset, float u) {
  return u > 0.0 && u < 1.0 ? spatial_bits * float(offset * offset) : NO_WEIGHT;
}

void main() {
  vec2 texel = 1.0 / vec2(textureSize(picture, 0));
  vec2 uv = gl_FragCoord.xy * texel;
  vec3 center = textureLod(picture, uv, 0.0).rgb;
  vec3 sum = vec3(0.0);
  float total = 0.0;
  for (int j = -HALF_FILTER; j <= HALF_FILTER; ++j) {
    float row = uv.y + float(j) * texel.y, row_bits = bits(j, row);
    for (int i = -HALF_FILTER; i <= HALF_FILTER; ++i) {
      float column = uv.x + float(i) * texel.x;
      vec3 change = textureLod(picture, vec2(column, row), 0.0).rgb - center;
      float weight = exp2(-(row_bits + bits(i, column) + range_bits * dot(change, change)));
      sum += weight * change;
      total += weight;
    }
  }
  smoothed = vec4(center + sum / total, 1.0);
}
