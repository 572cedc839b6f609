// Between passes 2 and 3: moves z away from the viewer by what a beam sees too early of a surface
// that it meets at an angle (RayCastingOptions::incidence_correction_m).
layout(binding = BIND_DEPTH) uniform sampler2D depth;
layout(binding = BIND_FILTERED) uniform sampler2D filtered;  // z after a box filter

uniform float axis_z_m;
uniform float face_radius_m;
// Length of the correction at ranges from first_row_m to last_row_m (correction_length()).
uniform float first_row_m, last_row_m;
uniform float lateral_m[BEAM_ROWS];
uniform float elevation_m[BEAM_ROWS];
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

// The stick through a position (hw::ProbeGeometry).
struct Stick {
  vec3 direction;
  vec3 elevation;  // across the image plane
  float range_m;
};

Stick stick_through(vec3 position) {
  vec2 from_axis = vec2(position.y, position.z - axis_z_m);
  float distance_m = length(from_axis);
  vec2 depth = from_axis / distance_m;
  vec3 from_centre = vec3(position.x, (axis_z_m + distance_m) * depth);
  float r = length(from_centre);
  return Stick(from_centre / r, vec3(0.0, -depth.y, depth.x), r - face_radius_m);
}

// Squares of the correction's lengths for tilts from stick to stick and from frame to frame.
vec2 squared_lengths(float range_m) {
  float row = clamp((range_m - first_row_m) / (last_row_m - first_row_m), 0.0, 1.0) *
              float(BEAM_ROWS - 1);
  int first = min(int(row), BEAM_ROWS - 2);
  vec2 lengths = mix(vec2(lateral_m[first], elevation_m[first]),
                     vec2(lateral_m[first + 1], elevation_m[first + 1]),
                     row - float(first));
  return lengths * lengths;
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
  Stick stick = stick_through(ray.origin + corrected * ray.direction);
  float sine = length(cross(normal, stick.direction));
  if (sine == 0.0) return;
  // Of the part of the normal across the stick, the share of its square along the elevation.
  float share = min(dot(normal, stick.elevation) / sine, 1.0);
  vec2 lengths2 = squared_lengths(stick.range_m);
  float length_m = sqrt(mix(lengths2.x, lengths2.y, share * share));
  // By this length times the tangent of incidence along the stick, as a step along the ray.
  corrected += length_m * min(sine / max(abs(dot(normal, ray.direction)), 1e-6), max_tangent);
}
