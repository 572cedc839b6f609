// Pass 1, first half, mode plain: scan conversion of a frame to a Cartesian slice (paper section
// 3.1). The LUT holds line, sample and a flag per pixel; empty space is skipped and becomes EMPTY.
layout(binding = BIND_POLAR_TABLE) uniform sampler2D polar_table;
layout(binding = BIND_FRAME) uniform sampler2D frame;  // column: sample, row: line

layout(location = 0) out float value;

void main() {
  vec3 entry = texelFetch(polar_table, ivec2(gl_FragCoord.xy), 0).rgb;
  if (entry.z == 0.0) {
    value = EMPTY;
    return;
  }
  // Bilinear in the shader, as a GPU's own filter has 8-bit fractions.
  ivec2 last = textureSize(frame, 0) - 1;
  ivec2 near = ivec2(floor(entry.yx));
  ivec2 far = min(near + 1, last);
  vec2 fraction = entry.yx - vec2(near);
  float near_line = mix(texelFetch(frame, near, 0).r,
                        texelFetch(frame, ivec2(far.x, near.y), 0).r, fraction.x);
  float far_line = mix(texelFetch(frame, ivec2(near.x, far.y), 0).r,
                       texelFetch(frame, far, 0).r, fraction.x);
  value = mix(near_line, far_line, fraction.y);
}
