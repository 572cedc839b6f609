// Put before a shader whose fetches are to be counted (render/gl/fetch_count.h): what follows calls
// these macros in place of GL's own functions, and ends as `counted_main`.
layout(location = 7) out vec4 fetch_counts;  // by sampler; behind the outputs of any pass

vec3 fetches = vec3(0.0);

float count_fetch(sampler2D s) { return ++fetches.x; }
float count_fetch(sampler3D s) { return ++fetches.y; }
float count_fetch(sampler2DArray s) { return ++fetches.z; }

#define textureLod(s, at, level) (count_fetch(s), textureLod(s, at, level))
#define texelFetch(s, at, level) (count_fetch(s), texelFetch(s, at, level))
#define main counted_main
