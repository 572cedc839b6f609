#include "bench/output/encoders.h"

#include "bench/output/loaded_library.h"

namespace wobblebench::bench {

namespace {

const Encoders& load() {
  using Offer = const Encoders*();
  return *reinterpret_cast<Offer*>(function_of_library(
      "wobblebench_encoders", "wobblebench_encoders", "no encoders of pictures and videos"))();
}

}  // namespace

const Encoders& encoders() {
  static const Encoders& loaded = load();
  return loaded;
}

}  // namespace wobblebench::bench
