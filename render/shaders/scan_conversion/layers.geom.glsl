// Routes an instance's triangle to its target layer and passes on the source layer.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;

uniform int source_layers[MAX_LAYERS];
uniform int target_layers[MAX_LAYERS];

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
