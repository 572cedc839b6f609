// Pass 2, mode plain: one ray a pixel, every step of it.
void main() {
  March march;
  int count = begin_pixel(march);
  if (count <= 0) return;
  empty_kernel();
  empty_buffer();
  for (int front = -HALF_KERNEL; front < count + HALF_KERNEL; ++front) {
    fetch_front(place_of(march, front), march.across_1, march.across_2);
    // The kernel is complete around the sample in its middle, HALF_KERNEL steps behind the front.
    int current = front - HALF_KERNEL;
    if (current >= 0 && look(march, current)) break;
  }
}
