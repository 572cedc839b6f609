// TAPS texture fetches per pixel and as little else as possible, for fetch_rate_per_us()
// (render/gl/fetch_count.h). Neighbouring pixels read neighbouring texels, so they are cached.
#if SAMPLER == SAMPLER_PLANE
layout(binding = BIND_FETCHED) uniform sampler2D fetched;
#elif SAMPLER == SAMPLER_VOLUME
layout(binding = BIND_FETCHED) uniform sampler3D fetched;
#else
layout(binding = BIND_FETCHED) uniform sampler2DArray fetched;
#endif

layout(location = 0) out float sum;

void main() {
  vec4 all = vec4(0.0);
  for (int tap = 0; tap < TAPS; ++tap) {
    vec2 uv = (gl_FragCoord.xy + 0.37 * float(tap)) / float(SIDE);
#if SAMPLER == SAMPLER_PLANE
    all += textureLod(fetched, uv, 0.0);
#elif SAMPLER == SAMPLER_VOLUME
    all += textureLod(fetched, vec3(uv, 0.5), 0.0);  // between two layers
#else
    all += textureLod(fetched, vec3(uv, 0.0), 0.0);
#endif
  }
  sum = dot(all, vec4(1.0));
}
