// Between passes 2 and 3: moves z away from the viewer by what a beam sees too early of a surface
// that it meets at an angle (RayCastingOptions::incidence_correction_m).
layout(binding = BIND_DEPTH) uniform sampler2D depth;
layout(binding = BIND_FILTERED) uniform sampler2D filtered;  // z after a box filter

uniform float axis_z_m;
uniform float correction_m;
uniform float max_tangent;

layout(location = 0) out float corrected;

// Difference of two neighbours' positions on the filtered surface; of this pixel and one of them
// where the other has no surface.
vec3 tangent(ivec2 pixel, ivec2 step) {
  ivec2 last = textureSize(filtered, 0) - 1;
  vec3 ends[2];
  for (int side = 0; side < 2; ++side) {
    ivec2 end = clamp(pixel + (2 * side - 1) * step, ivec2(0), last);
    float z = texelFetch(filtered, end, 0).r;
    if (z < 0.0) {
      end = pixel;
      z = texelFetch(filtered, pixel, 0).r;
    }
    Ray ray = picture_ray(vec2(end) + 0.5);
    ends[side] = ray.origin + z * ray.direction;
  }
  return ends[1] - ends[0];
}

// Direction of the stick through a position (hw::ProbeGeometry).
vec3 stick_direction(vec3 position) {
  vec2 from_axis = vec2(position.y, position.z - axis_z_m);
  float distance_m = length(from_axis);
  float plane_depth = axis_z_m + distance_m;
  return normalize(vec3(position.x, plane_depth * from_axis / distance_m));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  corrected = texelFetch(depth, pixel, 0).r;
  if (corrected < 0.0) return;
  vec3 across = cross(tangent(pixel, ivec2(1, 0)), tangent(pixel, ivec2(0, 1)));
  float area = length(across);
  if (area == 0.0) return;
  Ray ray = pixel_ray();
  vec3 normal = across / area;
  vec3 stick = stick_direction(ray.origin + corrected * ray.direction);
  float sine = length(cross(normal, stick));
  // By correction_m times the tangent of incidence along the stick, as a step along the ray.
  corrected += correction_m * min(sine / max(abs(dot(normal, ray.direction)), 1e-6), max_tangent);
}
