// Pass 3, second half: Blinn-Phong shading of the filtered z-buffer, Eq. (2), with cast shadows.
uniform vec3 light_position_m;   // point light
uniform vec3 light_direction;    // directional light: unit vector towards it
uniform vec3 base_rgb;
uniform float ambient, diffuse, specular, shininess;
uniform float shadow_coefficient;

#if RENDERED_BASE
layout(binding = BIND_COLOR) uniform sampler2D rendered;  // pass 2's alpha-blended picture
#endif

layout(location = 0) out vec4 surface;

vec3 position_at(ivec2 pixel, float z) { return view_position(vec2(pixel) + 0.5, z); }

// Central difference along one axis of the picture; one-sided where a neighbour is missing, and at
// constant z where both are.
vec3 tangent(ivec2 pixel, float z, ivec2 axis) {
  float before = depth_at(pixel - axis), after = depth_at(pixel + axis);
  bool isolated = before < 0.0 && after < 0.0;
  vec3 from = before < 0.0 && !isolated ? position_at(pixel, z)
                                        : position_at(pixel - axis, isolated ? z : before);
  vec3 to = after < 0.0 && !isolated ? position_at(pixel, z)
                                     : position_at(pixel + axis, isolated ? z : after);
  return to - from;
}

// Unit normal towards the viewer; a degenerate surface (at the eye itself) faces the viewer.
vec3 normal_at(ivec2 pixel, float z, vec3 to_viewer) {
  vec3 away = cross(tangent(pixel, z, ivec2(1, 0)), tangent(pixel, z, ivec2(0, 1)));
  float size = length(away);
  return size > 0.0 ? -away / size : to_viewer;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float z = depth_at(pixel);
  surface = vec4(0.0, 0.0, 0.0, 1.0);
  if (z < 0.0) return;
  vec3 position = position_at(pixel, z);
  vec3 to_viewer = -view_direction(vec2(pixel) + 0.5);
  vec3 normal = normal_at(pixel, z, to_viewer);
#if POINT_LIGHT
  float light_distance = length(light_position_m - position);
  vec3 to_light = light_distance > 0.0 ? (light_position_m - position) / light_distance : to_viewer;
#else
  float light_distance = 1e30;
  vec3 to_light = light_direction;
#endif
  // Eq. (2): I = I_ambient + I_diffuse + I_specular.
  float facing = dot(normal, to_light);
#if RENDERED_BASE
  vec3 base = base_rgb * texelFetch(rendered, pixel, 0).rgb;
#else
  vec3 base = base_rgb;
#endif
  vec3 color = base * (ambient + diffuse * max(facing, 0.0));
  if (facing > 0.0) {
    vec3 halfway = to_light + to_viewer;
    float along = dot(normal, halfway) / max(length(halfway), 1e-20);
    color += specular * pow(max(along, 0.0), shininess);
  }
#if SHADOWS
  if (in_shadow(position, to_light, light_distance)) color *= shadow_coefficient;
#endif
  surface.rgb = min(color, 1.0);
}
