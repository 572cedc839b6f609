// Pass 2, edge detection: Difference of Eq. (1) over the circular buffer. reaches_surface() says
// at which sample of the ray the surface lies; ray_march.glsl and ray_blocks.glsl turn it into z.
uniform float threshold;
uniform float edge_sign;  // +1: rising, -1: falling

float ring[BUFFER];  // circular buffer of the last n = BUFFER samples
int oldest;          // index of the oldest sample in `ring`
int taken;           // consecutive samples inside the cone
float difference, last_difference;  // Eq. (1) times edge_sign: now, and one sample before

void empty_buffer() {
  for (int i = 0; i < BUFFER; ++i) ring[i] = 0.0;
  oldest = 0;
  taken = 0;
  difference = 0.0;
}

// Adds a sample and updates Eq. (1) as a running sum: the newest sample enters the newer half, the
// middle one moves to the older half, the oldest one leaves. True if the buffer is full and
// Difference has reached the threshold.
bool reaches_surface(float newest) {
  last_difference = difference;
  int middle = oldest + BUFFER / 2;
  if (middle >= BUFFER) middle -= BUFFER;
  difference += edge_sign * (newest - 2.0 * ring[middle] + ring[oldest]);
  ring[oldest] = newest;
  oldest = oldest + 1 == BUFFER ? 0 : oldest + 1;
  ++taken;
  return taken >= BUFFER && difference >= threshold;
}

// Steps from the point where Difference crossed the threshold to the newest sample, by linear
// interpolation (docs/decisions/0003-interpolated-crossing.md).
float steps_past_crossing() {
#if REFINE_CROSSING
  if (taken > BUFFER) return (difference - threshold) / (difference - last_difference);
#endif
  return 0.0;
}
