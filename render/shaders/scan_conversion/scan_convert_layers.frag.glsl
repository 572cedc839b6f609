// Pass 1, mode fast, first of three: scan conversion of groups of four frames, for the pixels that
// rays read and a border around them. Pixels without data become 0.
layout(binding = BIND_POLAR_TABLE) uniform sampler2D polar_table;  // of these pixels
layout(binding = BIND_FRAMES) uniform sampler2DArray frames;  // (sample, line), RGBA: four frames

flat in int source_layer;

layout(location = 0) out vec4 group;

// Fetches by texture coordinates cost half as much as texelFetch on a CPU. The driver's linear
// filter is exact on a CPU; a GPU's 8-bit fractions err by at most 1/512 of the difference of two
// samples.
void main() {
  vec2 uv = gl_FragCoord.xy / vec2(textureSize(polar_table, 0));
  vec3 entry = textureLod(polar_table, uv, 0.0).rgb;
  vec2 polar = (entry.yx + 0.5) / vec2(textureSize(frames, 0).xy);
  group = entry.z * textureLod(frames, vec3(polar, float(source_layer)), 0.0);
}
