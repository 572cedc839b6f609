// Pass 2, mode plain: one ray per pixel, all of its steps.
void main() {
  March march;
  int count = begin_pixel(march);
  if (count <= 0) return;
  empty_kernel();
  empty_buffer(true);
  for (int front = -HALF_KERNEL; front < count + HALF_KERNEL; ++front) {
    fetch_front(sample_position(march, front), march.across_1, march.across_2);
    // The kernel is complete around the sample in its middle, HALF_KERNEL steps behind the front.
    int current = front - HALF_KERNEL;
    if (current >= 0 && process_sample(march, current)) break;
  }
}
