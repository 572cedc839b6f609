// Pass 2, edge detection. reaches_surface() says at which sample of the ray the surface lies;
// steps_past_crossing() how far behind it; ray_march.glsl and ray_cast_fast.frag.glsl turn them into
// z.
uniform float threshold;  // paper: on Difference; iso: level; floor: rise above the floor
uniform float edge_sign;  // +1: rising, -1: falling

int taken;                           // consecutive samples inside the cone
float difference, last_difference;  // beyond the threshold if >= threshold: now, a sample before

// Samples enter running sums as multiples of 2^-18: a sum of 64 of them is exact in float, so that
// adding the newest and taking off the oldest never drifts.
float on_grid(float value) { return roundEven(value * 262144.0) / 262144.0; }

#if DETECTOR == DETECTOR_ISO
// An iso-surface: the first sample beyond the level after one that was not, or with CAPS the first
// in the cone, unless the ray begins there.
const float NO_DIFFERENCE = -1e30;  // makes steps_past_crossing() 0

// `at_start`: the next sample is the ray's first.
void empty_buffer(bool at_start) {
  taken = at_start ? 1 : 0;
  difference = 0.0;
}

bool reaches_surface(bool inside, float newest) {
  last_difference = difference;
  difference = edge_sign * (newest - threshold);
  taken = inside ? taken + 1 : 0;
#if CAPS
  if (taken == 1 && difference >= 0.0) {
    last_difference = NO_DIFFERENCE;
    return true;
  }
#endif
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
// in the last FLOOR_BLOCKS + 1 blocks of MEAN steps, the newest of them unfinished. Blocks are
// counted from the ray's first step.
const float NO_LOW = 1e30;

float sum;                 // of the last MEAN samples
float lows[FLOOR_BLOCKS];  // least mean of each finished block, oldest first
float floor_before;        // least of `lows`
float newest_low;          // of the unfinished block

void empty_floor() {
  for (int i = 0; i < FLOOR_BLOCKS; ++i) lows[i] = NO_LOW;
  floor_before = NO_LOW;
  newest_low = NO_LOW;
  sum = 0.0;
  taken = 0;
  difference = 0.0;
}

// Of the sample that has entered `sum`.
bool rises_above_floor(bool inside) {
  taken = inside ? taken + 1 : 0;
  bool valid = taken >= MEAN;
  float mean = edge_sign * sum / float(MEAN);
  newest_low = valid ? min(newest_low, mean) : NO_LOW;
  floor_before = inside ? floor_before : NO_LOW;
  last_difference = difference;
  difference = valid ? mean - min(floor_before, newest_low) : 0.0;
  return valid && difference >= threshold;
}

void end_floor_block() {
  bool left_cone = taken < MEAN;  // no mean before
  float low = newest_low;
  for (int i = 0; i < FLOOR_BLOCKS - 1; ++i) {
    lows[i] = left_cone ? NO_LOW : lows[i + 1];
    low = min(low, lows[i]);
  }
  lows[FLOOR_BLOCKS - 1] = newest_low;
  floor_before = low;
  newest_low = NO_LOW;
}

// From the middle of the mean's samples.
float steps_past_crossing() {
  float past = 0.5 * float(MEAN - 1);
#if REFINE_CROSSING
  past += (difference - threshold) / (difference - last_difference);
#endif
  return past;
}

float ring[MEAN];  // circular buffer of the last samples
int oldest;        // index of the oldest sample in `ring`, and steps of the unfinished block

void empty_buffer(bool at_start) {
  for (int i = 0; i < MEAN; ++i) ring[i] = 0.0;
  oldest = 0;
  empty_floor();
}

bool reaches_surface(bool inside, float newest) {
  float sampled = inside ? on_grid(newest) : 0.0;
  sum += sampled - ring[oldest];
  ring[oldest] = sampled;
  bool reached = rises_above_floor(inside);
  if (++oldest == MEAN) {
    oldest = 0;
    end_floor_block();
  }
  return reached;
}

#else
// The paper's: Difference of Eq. (1) over the circular buffer.
float ring[BUFFER];  // circular buffer of the last n = BUFFER samples; 0 outside the cone
int oldest;          // index of the oldest sample in `ring`

void empty_buffer(bool at_start) {
  for (int i = 0; i < BUFFER; ++i) ring[i] = 0.0;
  oldest = 0;
  taken = 0;
  difference = 0.0;
}

// Eq. (1) as a running sum: the newest sample enters the newer half, the middle one moves to the
// older half, the oldest one leaves. True if the buffer is full of samples inside the cone and
// Difference has reached the threshold.
bool update_difference(bool inside, float newest, float middle, float last) {
  last_difference = difference;
  difference += edge_sign * (newest - 2.0 * middle + last);
  taken = inside ? taken + 1 : 0;
  return taken >= BUFFER && difference >= threshold;
}

bool reaches_surface(bool inside, float newest) {
  float sampled = inside ? on_grid(newest) : 0.0;
  int middle = oldest + BUFFER / 2;
  if (middle >= BUFFER) middle -= BUFFER;
  bool reached = update_difference(inside, sampled, ring[middle], ring[oldest]);
  ring[oldest] = sampled;
  oldest = oldest + 1 == BUFFER ? 0 : oldest + 1;
  return reached;
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
