// Sends an instance's triangle to its layer, and says which layer to read.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

uniform int source_layers[MOST_LAYERS];
uniform int target_layers[MOST_LAYERS];

flat in int instance[];
flat out int source_layer;

void main() {
  for (int corner = 0; corner < 3; ++corner) {
    gl_Position = gl_in[corner].gl_Position;
    gl_Layer = target_layers[instance[0]];
    source_layer = source_layers[instance[0]];
    EmitVertex();
  }
  EndPrimitive();
}
