// Pass 1, mode fast, first of three: as scan_convert.frag.glsl, for groups of four frames at once, of
// the pixels that rays read and a border around them. Pixels without data become 0.
layout(binding = BIND_POLAR_TABLE) uniform sampler2D polar_table;  // of these pixels
layout(binding = BIND_FRAMES) uniform sampler2DArray frames;  // sample, line; a group's four frames

flat in int source_layer;

layout(location = 0) out vec4 group;

// Fetches by texture coordinates: on a CPU they cost half of what texelFetch does. The driver's own
// linear filter is exact on a CPU; a GPU's 8-bit fractions cost at most a 512th of what two samples
// differ by.
void main() {
  vec2 place = gl_FragCoord.xy / vec2(textureSize(polar_table, 0));
  vec3 entry = textureLod(polar_table, place, 0.0).rgb;
  vec2 at = (entry.yx + 0.5) / vec2(textureSize(frames, 0).xy);
  group = entry.z * textureLod(frames, vec3(at, float(source_layer)), 0.0);
}
