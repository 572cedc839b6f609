// Of four quadrants' values, (-x, -y), (+x, -y), (-x, +y), (+x, +y), that of a direction.
float quadrant(vec4 values, bvec2 positive) {
  vec2 pair = positive.y ? values.zw : values.xy;
  return positive.x ? pair.y : pair.x;
}
