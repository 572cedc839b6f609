// What a plan of scenes lets an option be: one value, or a draw from a distribution.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace wobblebench::bench {

/// A number in (0, 1) for one key of one scene: a hash of seed, index and key, so that no draw
/// depends on another, nor on the order in which they are made.
double unit_draw(std::uint64_t seed, std::uint64_t index, std::string_view key);

/// How an option is drawn. Each kind inverts its distribution function, so that one number in
/// (0, 1) makes one value.
struct Distribution {
  enum class Kind { constant, uniform, normal, integers, choice };
  Kind kind = Kind::constant;
  double low = 0, high = 0;         ///< the ends of all kinds of numbers, which both may be drawn
  double mean = 0, spread = 0;      ///< normal: before it is cut off at the ends
  std::vector<std::string> values;  ///< choice, and the constant: as in TOML
  std::vector<double> shares;       ///< choice: up to and with each value; the last is 1

  /// The value as in TOML: of real numbers six significant digits, within the ends.
  std::string at(double unit) const;
  /// The values that others lie between, or all values of a choice.
  std::vector<std::string> extremes() const;
  bool is_drawn() const { return kind != Kind::constant; }
};

/// Names of the keys that make a distribution, as in { normal = [0, 25], within = [-60, 60] }.
bool is_distribution_word(std::string_view word);

/// One word of a distribution and its value, as in TOML.
struct DistributionWord {
  std::string word, value;
};

/// Throws std::invalid_argument with what is wrong and what is allowed.
Distribution read_distribution(const std::vector<DistributionWord>& words);

}  // namespace wobblebench::bench
