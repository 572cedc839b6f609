// Pass 1, mode fast: bounds of the macrocells between two slices
// (render/leaping/skippable_cells.h), over each cell's pixels and those that a bilinear fetch in
// the cell also reads. One draw handles groups of four slices, CELL_ROWS rows of cells each, and
// the three intervals between the slices of each group.
layout(binding = BIND_SLICES) uniform sampler2DArray slices;

// For each interval: minimum and maximum value, largest rise and fall along x; then the largest
// rise and fall along depth and from frame to frame.
layout(location = 0) out vec4 values_and_x_0;
layout(location = 1) out vec4 values_and_x_1;
layout(location = 2) out vec4 values_and_x_2;
#if SLOPES
layout(location = 3) out vec4 depth_and_frame_0;
layout(location = 4) out vec4 depth_and_frame_1;
layout(location = 5) out vec4 depth_and_frame_2;
#endif

void main() {
  vec2 size = vec2(textureSize(slices, 0).xy);
  float group = floor(gl_FragCoord.y / float(CELL_ROWS));
  vec2 cell = floor(vec2(gl_FragCoord.x, gl_FragCoord.y - group * float(CELL_ROWS)));
  vec2 first = float(CELL) * cell - 0.5;  // clamped at the slices' edges
  vec4 low = vec4(1e30), high = vec4(-1e30);
  vec4 x_rise = vec4(0.0), x_fall = vec4(0.0), depth_rise = vec4(0.0), depth_fall = vec4(0.0);
  vec3 frame_rise = vec3(0.0), frame_fall = vec3(0.0);  // falls are negative until the end
  vec4 above[CELL + 2];
  for (int row = 0; row < CELL + 2; ++row) {
    vec4 left;
    for (int column = 0; column < CELL + 2; ++column) {
      vec2 uv = (first + vec2(column, row)) / size;
      vec4 value = textureLod(slices, vec3(uv, group), 0.0);
      low = min(low, value);
      high = max(high, value);
#if SLOPES
      if (column > 0) {
        x_rise = max(x_rise, value - left);
        x_fall = min(x_fall, value - left);
      }
      if (row > 0) {
        depth_rise = max(depth_rise, value - above[column]);
        depth_fall = min(depth_fall, value - above[column]);
      }
      frame_rise = max(frame_rise, value.yzw - value.xyz);
      frame_fall = min(frame_fall, value.yzw - value.xyz);
      left = value;
      above[column] = value;
#endif
    }
  }
  vec3 lowest = min(low.xyz, low.yzw), highest = max(high.xyz, high.yzw);
  vec3 x_up = max(x_rise.xyz, x_rise.yzw), x_down = -min(x_fall.xyz, x_fall.yzw);
  vec3 up = max(depth_rise.xyz, depth_rise.yzw), down = -min(depth_fall.xyz, depth_fall.yzw);
  values_and_x_0 = vec4(lowest.x, highest.x, x_up.x, x_down.x);
  values_and_x_1 = vec4(lowest.y, highest.y, x_up.y, x_down.y);
  values_and_x_2 = vec4(lowest.z, highest.z, x_up.z, x_down.z);
#if SLOPES
  depth_and_frame_0 = vec4(up.x, down.x, frame_rise.x, -frame_fall.x);
  depth_and_frame_1 = vec4(up.y, down.y, frame_rise.y, -frame_fall.y);
  depth_and_frame_2 = vec4(up.z, down.z, frame_rise.z, -frame_fall.z);
#endif
}
