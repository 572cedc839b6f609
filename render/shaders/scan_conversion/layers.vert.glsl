// One triangle that covers the whole target, per instance; each instance draws one layer.
flat out int instance;

void main() {
  instance = gl_InstanceID;
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}
