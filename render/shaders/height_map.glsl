// The filtered z-buffer, as shading and shadows read it.
layout(binding = BIND_DEPTH) uniform sampler2D depth;

// z at a pixel; negative where there is no surface or no picture.
float depth_at(ivec2 pixel) {
  ivec2 size = textureSize(depth, 0);
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) return NO_SURFACE;
#if FAST
  return textureLod(depth, (vec2(pixel) + 0.5) / vec2(size), 0.0).r;
#else
  return texelFetch(depth, pixel, 0).r;
#endif
}
