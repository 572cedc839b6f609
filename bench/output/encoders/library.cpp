// What bench/output/encoders.cpp looks up.
#include "bench/output/encoders/image_encoder.h"
#include "bench/output/encoders/video_encoder.h"

extern "C" const wobblebench::bench::Encoders* wobblebench_encoders() {
  using namespace wobblebench::bench;
  static constexpr Encoders encoders{encode_image, open_video};
  return &encoders;
}
