// Pass 2, mode fast without a kernel along the ray: edge_detector.glsl for BLOCK samples at a time.
// The samples before a block are kept in their order and move on once a block, so that all indices
// are constants: an index that is not goes to memory, which on a CPU costs as much as a fetch.
float newer[BLOCK];  // samples of this block; 0 outside the cone

#if DETECT && DETECTOR != DETECTOR_ISO
#if DETECTOR == DETECTOR_FLOOR
#define OLDER MEAN
#else
#define OLDER BUFFER
#endif
float older[OLDER];  // the samples before it, oldest first

// A loop of more turns than drivers unroll, as two of constant lengths.
const int ROW = 8;
const int ROWS = (OLDER + ROW - 1) / ROW;

void empty_older() {
  for (int row = 0; row < ROWS; ++row) {
    for (int column = 0; column < ROW; ++column) {
      older[min(row * ROW + column, OLDER - 1)] = 0.0;
    }
  }
}

// The sample `back` steps before the block's sample `j`, at most OLDER.
float sample_before(int j, int back) {
  return j >= back ? newer[max(j - back, 0)] : older[clamp(OLDER + j - back, 0, OLDER - 1)];
}

// What sample i of `older` becomes once the block lies before it.
float sample_after(int i) {
  return i + BLOCK < OLDER ? older[min(i + BLOCK, OLDER - 1)]
                           : newer[clamp(i + BLOCK - OLDER, 0, BLOCK - 1)];
}

void keep_block() {
  for (int row = 0; row < ROWS; ++row) {
    for (int column = 0; column < ROW; ++column) {
      int i = row * ROW + column;
      if (i < OLDER) older[min(i, OLDER - 1)] = sample_after(i);
    }
  }
}
#endif

#if !DETECT
void empty_block(bool at_start) {}
void end_block() {}
#elif DETECTOR == DETECTOR_ISO
void empty_block(bool at_start) { empty_buffer(at_start); }
bool reaches_surface_in_block(bool inside, int j) { return reaches_surface(inside, newer[j]); }
void end_block() {}
#elif DETECTOR == DETECTOR_FLOOR
void empty_block(bool at_start) {
  empty_older();
  empty_floor();
}
bool reaches_surface_in_block(bool inside, int j) {
  sum += newer[j] - older[j];
  return rises_above_floor(inside);
}
void end_block() {
  keep_block();
  end_floor_block();
}
#else
void empty_block(bool at_start) {
  empty_older();
  taken = 0;
  difference = 0.0;
}
bool reaches_surface_in_block(bool inside, int j) {
  return update_difference(
      inside, newer[j], sample_before(j, BUFFER / 2), sample_before(j, BUFFER));
}
void end_block() { keep_block(); }
#endif
