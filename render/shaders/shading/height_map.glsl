// Pass 3, shared: access to the filtered z-buffer for shading and shadows.
layout(binding = BIND_DEPTH) uniform sampler2D depth;

// z of a pixel in metres; negative without a surface or outside the picture.
float depth_at(ivec2 pixel) {
  ivec2 size = textureSize(depth, 0);
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) return NO_SURFACE;
#if FAST
  return textureLod(depth, (vec2(pixel) + 0.5) / vec2(size), 0.0).r;
#else
  return texelFetch(depth, pixel, 0).r;
#endif
}
