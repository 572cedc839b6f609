// Random choices that are the same on every machine.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace wobblebench::bench::testing {

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : random_(seed) {}

  /// In [0, count).
  std::size_t below(std::size_t count) { return random_() % count; }
  bool chance(double probability) {
    return static_cast<double>(random_() >> 11) * 0x1p-53 < probability;
  }
  template <class T>
  const T& one_of(const std::vector<T>& choices) {
    return choices.at(below(choices.size()));
  }
  std::string letters(std::size_t count) {
    std::string text;
    while (text.size() < count) text += static_cast<char>('a' + below(26));
    return text;
  }

 private:
  std::mt19937_64 random_;
};

}  // namespace wobblebench::bench::testing
