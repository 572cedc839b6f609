// Pass 3, second half: Blinn-Phong of the filtered z-buffer, Eq. (2), and shadows.
uniform vec3 light_position_m;   // point light
uniform vec3 light_direction;    // directional light: unit vector towards it
uniform vec3 base_rgb;
uniform float ambient, diffuse, specular, shininess;
uniform float shadow_coefficient;

layout(location = 0) out vec4 surface;

vec3 position_at(ivec2 pixel, float z) { return view_position(vec2(pixel) + 0.5, z); }

// Central difference along one axis of the picture, one-sided where a neighbour is missing. Where
// both are, the surface is taken as equally deep.
vec3 tangent(ivec2 pixel, float z, ivec2 axis) {
  float before = depth_at(pixel - axis), after = depth_at(pixel + axis);
  bool alone = before < 0.0 && after < 0.0;
  vec3 from = before < 0.0 && !alone ? position_at(pixel, z)
                                     : position_at(pixel - axis, alone ? z : before);
  vec3 to = after < 0.0 && !alone ? position_at(pixel, z)
                                  : position_at(pixel + axis, alone ? z : after);
  return to - from;
}

// Towards the viewer. A surface on the eye itself has no normal: it faces the viewer.
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
  vec3 place = position_at(pixel, z);
  vec3 to_viewer = -view_direction(vec2(pixel) + 0.5);
  vec3 normal = normal_at(pixel, z, to_viewer);
#if POINT_LIGHT
  float light_distance = length(light_position_m - place);
  vec3 to_light = light_distance > 0.0 ? (light_position_m - place) / light_distance : to_viewer;
#else
  float light_distance = 1e30;
  vec3 to_light = light_direction;
#endif
  float facing = dot(normal, to_light);
  vec3 color = base_rgb * (ambient + diffuse * max(facing, 0.0));
  if (facing > 0.0) {
    vec3 halfway = to_light + to_viewer;
    float along = dot(normal, halfway) / max(length(halfway), 1e-20);
    color += specular * pow(max(along, 0.0), shininess);
  }
#if SHADOWS
  if (in_shadow(place, to_light, light_distance)) color *= shadow_coefficient;
#endif
  surface.rgb = min(color, 1.0);
}
