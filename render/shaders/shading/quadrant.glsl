// Selects, of the values of the quadrants (-x, -y), (+x, -y), (-x, +y), (+x, +y), that of a
// direction, given as the signs of its components.
float quadrant(vec4 values, bvec2 positive) {
  vec2 pair = positive.y ? values.zw : values.xy;
  return positive.x ? pair.y : pair.x;
}
