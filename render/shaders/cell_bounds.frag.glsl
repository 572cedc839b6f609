// Bounds of what a cell between two frames holds (render/quiet_cells.h): its pixels, those that a
// fetch in it reads besides, in both slices.
layout(binding = BIND_SLICES) uniform sampler2DArray slices;  // red: a slice, green: the next

flat in int source_layer;

layout(location = 0) out vec4 values_and_x;     // least, greatest; greatest rise and fall along x
layout(location = 1) out vec4 depth_and_frame;  // along depth, and from frame to frame

void main() {
  vec2 size = vec2(textureSize(slices, 0).xy);
  vec2 first = float(CELL) * floor(gl_FragCoord.xy) - 0.5;  // clamped at the slices' edges
  vec2 low = vec2(1e30), high = vec2(-1e30);
  vec2 x_rise = vec2(0.0), x_fall = vec2(0.0), depth_rise = vec2(0.0), depth_fall = vec2(0.0);
  float frame_rise = 0.0, frame_fall = 0.0;  // falls as negative rises, until the end
  vec2 above[CELL + 2];
  for (int row = 0; row < CELL + 2; ++row) {
    vec2 before;
    for (int column = 0; column < CELL + 2; ++column) {
      vec2 at = (first + vec2(column, row)) / size;
      vec2 here = textureLod(slices, vec3(at, float(source_layer)), 0.0).rg;
      low = min(low, here);
      high = max(high, here);
      if (column > 0) {
        x_rise = max(x_rise, here - before);
        x_fall = min(x_fall, here - before);
      }
      if (row > 0) {
        depth_rise = max(depth_rise, here - above[column]);
        depth_fall = min(depth_fall, here - above[column]);
      }
      frame_rise = max(frame_rise, here.g - here.r);
      frame_fall = min(frame_fall, here.g - here.r);
      before = here;
      above[column] = here;
    }
  }
  values_and_x = vec4(min(low.r, low.g), max(high.r, high.g), max(x_rise.r, x_rise.g),
                      -min(x_fall.r, x_fall.g));
  depth_and_frame = vec4(max(depth_rise.r, depth_rise.g), -min(depth_fall.r, depth_fall.g),
                         frame_rise, -frame_fall);
}
