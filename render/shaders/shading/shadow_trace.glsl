// Pass 3, mode plain: cast shadows by tracing from each pixel towards the light through the height
// map, one pixel of the picture per step (paper section 3.3, Fig. 4).
uniform float shadow_bias_m;

// Whether the height map occludes the light.
bool in_shadow(vec3 position, vec3 to_light, float light_distance) {
  float travelled = 0.0;
  for (int i = 0; i < MAX_SHADOW_STEPS; ++i) {
    vec3 here = position + travelled * to_light;
    travelled += 1.0 / max(pixels_per_m(here, to_light), 1e-3);
    if (travelled >= light_distance) return false;
    here = position + travelled * to_light;
    if (here.z <= 0.0) return false;  // in front of the view plane, or behind the eye
    vec3 projected = to_picture(here);
    if (any(lessThan(projected.xy, vec2(0.0))) ||
        any(greaterThanEqual(projected.xy, vec2(image_size)))) {
      return false;
    }
    float height = depth_at(ivec2(projected.xy));
    if (height >= 0.0 && height + shadow_bias_m < projected.z) return true;
  }
  return false;
}
