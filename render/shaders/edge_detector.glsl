// Pass 2, shared: the surface, Eq. (1).
uniform float threshold;
uniform float edge_sign;  // +1: rising, -1: falling

// The circular buffer, and Difference as a running sum.
float ring[BUFFER];
int taken;  // samples in a row inside the cone
float difference, last_difference;
int oldest;  // place of the oldest sample

void empty_buffer() {
  for (int i = 0; i < BUFFER; ++i) ring[i] = 0.0;
  oldest = 0;
  taken = 0;
  difference = 0.0;
}

// Takes the next sample; true if Difference of a full buffer has reached the threshold. The newest
// sample enters the newer half, the middle one moves to the older half, and the oldest leaves.
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

// How many steps before the newest sample Difference passed the threshold.
float steps_past_crossing() {
#if REFINE_CROSSING
  if (taken > BUFFER) return (difference - threshold) / (difference - last_difference);
#endif
  return 0.0;
}
