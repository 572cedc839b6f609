#include "bench/output/encoders.h"

#include <exception>

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

std::future<void> load_encoders_early() {
  return std::async(std::launch::async, [] {
    try {
      static_cast<void>(encoders());
    } catch (const std::exception&) {
      // Tried again, and reported, where they are needed.
    }
  });
}

}  // namespace wobblebench::bench
