// Prepended to a shader whose texture fetches are counted (render/gl/fetch_count.h): the shader
// then calls these macros in place of GL's functions, and its main() becomes `counted_main`.
layout(location = FETCH_COUNT_LOCATION) out vec4 fetch_counts;  // by TextureFetch::Sampler

vec3 fetches = vec3(0.0);

float count_fetch(sampler2D s) { return ++fetches[SAMPLER_PLANE]; }
float count_fetch(sampler3D s) { return ++fetches[SAMPLER_VOLUME]; }
float count_fetch(sampler2DArray s) { return ++fetches[SAMPLER_LAYERS]; }

#define textureLod(s, at, level) (count_fetch(s), textureLod(s, at, level))
#define texelFetch(s, at, level) (count_fetch(s), texelFetch(s, at, level))
#define main counted_main
