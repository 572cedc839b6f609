// Pass 3, mode fast: minimum z of each block of BLOCK x BLOCK pixels; NOTHING_NEAR if the block has
// no surface.
layout(binding = BIND_DEPTH) uniform sampler2D depth;

layout(location = 0) out float nearest;

void main() {
  ivec2 size = textureSize(depth, 0);
  ivec2 low = ivec2(gl_FragCoord.xy) * BLOCK, high = min(low + BLOCK, size);
  nearest = NOTHING_NEAR;
  for (int row = low.y; row < high.y; ++row) {
    for (int column = low.x; column < high.x; ++column) {
      float z = textureLod(depth, (vec2(column, row) + 0.5) / vec2(size), 0.0).r;
      if (z >= 0.0) nearest = min(nearest, z);
    }
  }
}
