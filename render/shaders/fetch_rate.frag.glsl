// Fetches and nothing else, as far as a shader can: for render/gl/fetch_count.h. From one layer, or
// from between two of a 3D texture: what fetches cost that find their texels at hand.
#if SAMPLER == 0
layout(binding = 0) uniform sampler2D fetched;
#elif SAMPLER == 1
layout(binding = 0) uniform sampler3D fetched;
#else
layout(binding = 0) uniform sampler2DArray fetched;
#endif

layout(location = 0) out float sum;

void main() {
  vec4 all = vec4(0.0);
  for (int tap = 0; tap < TAPS; ++tap) {
    vec2 at = (gl_FragCoord.xy + 0.37 * float(tap)) / float(SIDE);
#if SAMPLER == 0
    all += textureLod(fetched, at, 0.0);
#elif SAMPLER == 1
    all += textureLod(fetched, vec3(at, 0.5), 0.0);
#else
    all += textureLod(fetched, vec3(at, 0.0), 0.0);
#endif
  }
  sum = dot(all, vec4(1.0));
}
