// Pass 2, edge detection. reaches_surface() says at which sample of the ray the surface lies;
// steps_past_crossing() how far behind it; ray_march.glsl and ray_blocks.glsl turn them into z.
uniform float threshold;  // paper: on Difference; iso: level; floor: rise above the floor
uniform float edge_sign;  // +1: rising, -1: falling

int taken;                           // consecutive samples inside the cone
float difference, last_difference;  // beyond the threshold if >= threshold: now, a sample before

#if DETECTOR == DETECTOR_ISO
// An iso-surface: the first sample beyond the level after one that was not.
void empty_buffer() {
  taken = 0;
  difference = 0.0;
}

bool reaches_surface(float newest) {
  last_difference = difference;
  difference = edge_sign * (newest - threshold);
  ++taken;
  return taken >= BUFFER && last_difference < 0.0 && difference >= 0.0;
}

float steps_past_crossing() {
#if REFINE_CROSSING
  return difference / (difference - last_difference);
#else
  return 0.0;
#endif
}

#elif DETECTOR == DETECTOR_FLOOR
// A rise above a local floor: the mean of the last MEAN samples (1 mm) over the least of such means
// in the last FLOOR_BLOCKS + 1 blocks of MEAN samples, the newest of them unfinished.
float ring[MEAN];    // circular buffer of the last samples
int oldest;          // index of the oldest sample in `ring`
float sum;           // of `ring`
float lows[FLOOR_BLOCKS];  // least mean of each finished block
int oldest_low;
float newest_low;    // of the unfinished block
int in_block;        // means in it

const float NO_LOW = 1e30;

void empty_buffer() {
  for (int i = 0; i < MEAN; ++i) ring[i] = 0.0;
  for (int i = 0; i < FLOOR_BLOCKS; ++i) lows[i] = NO_LOW;
  oldest = 0;
  oldest_low = 0;
  in_block = 0;
  newest_low = NO_LOW;
  sum = 0.0;
  taken = 0;
  difference = 0.0;
}

bool reaches_surface(float newest) {
  sum += newest - ring[oldest];
  ring[oldest] = newest;
  oldest = oldest + 1 == MEAN ? 0 : oldest + 1;
  ++taken;
  if (taken < MEAN) return false;
  float mean = edge_sign * sum / float(MEAN);
  newest_low = min(newest_low, mean);
  float low = newest_low;
  for (int i = 0; i < FLOOR_BLOCKS; ++i) low = min(low, lows[i]);
  if (++in_block == MEAN) {
    lows[oldest_low] = newest_low;
    oldest_low = oldest_low + 1 == FLOOR_BLOCKS ? 0 : oldest_low + 1;
    newest_low = NO_LOW;
    in_block = 0;
  }
  last_difference = difference;
  difference = mean - low;
  return difference >= threshold;
}

// From the middle of the mean's samples.
float steps_past_crossing() {
  float past = 0.5 * float(MEAN - 1);
#if REFINE_CROSSING
  past += (difference - threshold) / (difference - last_difference);
#endif
  return past;
}

#else
// The paper's: Difference of Eq. (1) over the circular buffer.
float ring[BUFFER];  // circular buffer of the last n = BUFFER samples
int oldest;          // index of the oldest sample in `ring`

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
#endif
