// Pass 3, mode fast: minimum z of a tile and its neighbours, one channel for each quadrant of
// directions (quadrant()). A ray that moves at most one tile's side along either axis stays
// within the 2 x 2 tiles of its quadrant (quadrants), at most two sides within 3 x 3
// (wide_quadrants).
layout(binding = BIND_NEAREST) uniform sampler2D nearest;  // minimum z of each tile

layout(location = 0) out vec4 quadrants;
layout(location = 1) out vec4 wide_quadrants;

float nearest_in(ivec2 tile) {
  ivec2 last = textureSize(nearest, 0) - 1;
  return texelFetch(nearest, clamp(tile, ivec2(0), last), 0).r;
}

void main() {
  ivec2 tile = ivec2(gl_FragCoord.xy);
  for (int i = 0; i < 4; ++i) {
    ivec2 side = ivec2((i & 1) * 2 - 1, (i & 2) - 1);
    quadrants[i] = wide_quadrants[i] = NOTHING_NEAR;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        float z = nearest_in(tile + side * ivec2(column, row));
        if (max(row, column) < 2) quadrants[i] = min(quadrants[i], z);
        wide_quadrants[i] = min(wide_quadrants[i], z);
      }
    }
  }
}
