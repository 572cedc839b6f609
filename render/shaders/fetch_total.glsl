// Appended to a shader whose texture fetches are counted.
#undef main
void main() {
  counted_main();
  fetch_counts = vec4(fetches, 0.0);
}
