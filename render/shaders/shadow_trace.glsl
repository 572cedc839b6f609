// Pass 3, plain: shadows by tracing the height map from each pixel towards the light, a pixel of
// the picture at a time.
uniform float shadow_bias_m;

// Does the height map stand in the way of the light? One pixel of the picture at a time.
bool in_shadow(vec3 place, vec3 to_light, float light_distance) {
  float travelled = 0.0;
  for (int i = 0; i < MAX_SHADOW_STEPS; ++i) {
    vec3 here = place + travelled * to_light;
    travelled += 1.0 / max(pixels_per_m(here, to_light), 1e-3);
    if (travelled >= light_distance) return false;
    here = place + travelled * to_light;
    if (here.z <= 0.0) return false;  // before the view plane, or behind the eye
    vec3 seen = to_picture(here);
    if (any(lessThan(seen.xy, vec2(0.0))) || any(greaterThanEqual(seen.xy, vec2(image_size)))) {
      return false;
    }
    float height = depth_at(ivec2(seen.xy));
    if (height >= 0.0 && height + shadow_bias_m < seen.z) return true;
  }
  return false;
}
