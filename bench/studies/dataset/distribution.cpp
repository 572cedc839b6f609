#include "bench/studies/dataset/distribution.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>
#include <sstream>
#include <stdexcept>

#include "base/hash.h"
#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

constexpr std::array<std::string_view, 6> kWords = {
    "uniform", "normal", "within", "integers", "choice", "weights"};
constexpr int kDigits = 6;
/// Whole numbers up to it are exact as double.
constexpr std::int64_t kMostInteger = std::int64_t{1} << 53;
/// A normal distribution of which less lies within its ends is refused: it is a slip.
constexpr double kLeastWithin = 1e-6;

[[noreturn]] void refuse(const std::string& allowed) {
  throw std::invalid_argument(allowed);
}

/// The list that a word stands for.
toml::array list_of(const DistributionWord& word) {
  try {
    const toml::table table = toml::parse("value = " + word.value);
    if (const toml::array* list = table["value"].as_array()) return *list;
  } catch (const toml::parse_error&) {
    // The refusal below says what is allowed.
  }
  refuse(word.word + " must be a list");
}

std::vector<double> numbers_of(const DistributionWord& word) {
  std::vector<double> numbers;
  for (const toml::node& node : list_of(word)) {
    const auto number = node.value<double>();
    if (!node.is_number() || !number || !std::isfinite(*number)) {
      refuse(word.word + " must be a list of numbers");
    }
    numbers.push_back(*number);
  }
  return numbers;
}

/// Two numbers, the first below the second.
void read_ends(const DistributionWord& word, Distribution& made) {
  const auto ends = numbers_of(word);
  if (ends.size() != 2 || ends[0] >= ends[1]) {
    refuse(word.word + " must be [LOW, HIGH] with LOW below HIGH");
  }
  made.low = ends[0];
  made.high = ends[1];
}

double normal_share(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

void check_within(const Distribution& made) {
  const auto share = [&](double value) { return normal_share((value - made.mean) / made.spread); };
  if (share(made.high) - share(made.low) >= kLeastWithin) return;
  refuse("within holds less than a millionth of the normal distribution");
}

std::string text_of(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

void read_choice(const DistributionWord& word, Distribution& made) {
  for (const toml::node& node : list_of(word)) {
    std::string text = text_of(node);
    std::ranges::replace(text, '\n', ' ');
    made.values.push_back(std::move(text));
  }
  if (made.values.empty()) refuse("choice must have one or more values");
  const std::set<std::string> different(made.values.begin(), made.values.end());
  if (different.size() != made.values.size()) refuse("choice has a value twice");
}

void set_shares(const std::vector<double>& weights, Distribution& made) {
  double sum = 0;
  for (const double weight : weights) sum += weight;
  double share = 0;
  for (const double weight : weights) made.shares.push_back((share += weight) / sum);
  made.shares.back() = 1;
}

void read_weights(const DistributionWord* word, Distribution& made) {
  if (word == nullptr) {
    set_shares(std::vector<double>(made.values.size(), 1), made);
    return;
  }
  const auto weights = numbers_of(*word);
  if (weights.size() != made.values.size()) {
    refuse("weights has " + std::to_string(weights.size()) + " numbers for " +
           std::to_string(made.values.size()) + " values of choice");
  }
  if (std::ranges::any_of(weights, [](double weight) { return weight <= 0; })) {
    refuse("weights must be above 0; a value that is never drawn is left out of choice");
  }
  set_shares(weights, made);
}

/// The words of one distribution, each at most once.
class Words {
 public:
  explicit Words(const std::vector<DistributionWord>& words) : words_(words) {}

  const DistributionWord* find(std::string_view name) const {
    const auto found = std::ranges::find(words_, name, &DistributionWord::word);
    return found == words_.end() ? nullptr : &*found;
  }
  /// Whether `kind` is there; no other word may be but `with`.
  bool is(std::string_view kind, std::string_view with = "") const {
    if (find(kind) == nullptr) return false;
    for (const DistributionWord& word : words_) {
      if (word.word == kind || word.word == with) continue;
      refuse(word.word + " does not go with " + std::string(kind));
    }
    return true;
  }

 private:
  const std::vector<DistributionWord>& words_;
};

void read_normal(const Words& words, Distribution& made) {
  const auto law = numbers_of(*words.find("normal"));
  if (law.size() != 2 || law[1] <= 0) refuse("normal must be [MEAN, SPREAD] with SPREAD above 0");
  if (words.find("within") == nullptr) refuse("normal needs within = [LOW, HIGH]");
  made.mean = law[0];
  made.spread = law[1];
  read_ends(*words.find("within"), made);
  check_within(made);
}

void read_integers(const DistributionWord& word, Distribution& made) {
  for (const toml::node& node : list_of(word)) {
    const auto number = node.as_integer();
    if (number == nullptr || std::abs(number->get()) > kMostInteger) {
      refuse("integers must be two whole numbers of at most 2^53");
    }
  }
  read_ends(word, made);
}

/// The quantile of the normal distribution within the ends.
double normal_at(const Distribution& of, double unit) {
  // The upper tail is reached from above, where its shares are exact.
  const bool upper = of.low > of.mean;
  const double sign = upper ? -1 : 1;
  const auto share = [&](double value) {
    return normal_share(sign * (value - of.mean) / of.spread);
  };
  const double from = share(of.low), to = share(of.high);
  const double p = std::clamp(from + unit * (to - from), 1e-300, 1 - 1e-16);
  return of.mean - sign * of.spread * std::numbers::sqrt2 * boost::math::erfc_inv(2 * p);
}

std::string real_text(const Distribution& of, double value) {
  const double rounded = std::stod(significant(value, kDigits));
  const bool inside = rounded >= of.low && rounded <= of.high;
  return inside ? significant(rounded, kDigits)
                : significant(std::clamp(value, of.low, of.high), 17);
}

std::string integer_text(const Distribution& of, double unit) {
  const double count = of.high - of.low + 1;
  const double value = of.low + std::min(std::floor(unit * count), count - 1);
  return std::to_string(static_cast<std::int64_t>(value));
}

}  // namespace

double unit_draw(std::uint64_t seed, std::uint64_t index, std::string_view key) {
  std::uint64_t hash = mix64(mix64(seed + kGoldenGamma) + (index + 1) * kGoldenGamma);
  for (const char letter : key) {
    hash = mix64(hash ^
                 (static_cast<std::uint64_t>(static_cast<unsigned char>(letter)) + kGoldenGamma));
  }
  // Half a step inside both ends: the quantiles of 0 and 1 may be infinite.
  return std::min(unit_interval(hash) + 0x1p-54, 1 - 0x1p-53);
}

bool is_distribution_word(std::string_view word) {
  return std::ranges::find(kWords, word) != kWords.end();
}

std::string Distribution::at(double unit) const {
  switch (kind) {
    case Kind::constant:
      return values.front();
    case Kind::uniform:
      return real_text(*this, low + unit * (high - low));
    case Kind::normal:
      return real_text(*this, normal_at(*this, unit));
    case Kind::integers:
      return integer_text(*this, unit);
    case Kind::choice:
      break;
  }
  const auto found = std::ranges::upper_bound(shares, unit);
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  return values[static_cast<std::size_t>(std::min(found - shares.begin(), last))];
}

std::vector<std::string> Distribution::extremes() const {
  if (kind == Kind::constant || kind == Kind::choice) return values;
  if (kind == Kind::integers) return {integer_text(*this, 0), integer_text(*this, 1)};
  return {real_text(*this, low), real_text(*this, high)};
}

Distribution read_distribution(const std::vector<DistributionWord>& words) {
  const Words all(words);
  Distribution made;
  if (all.is("uniform")) {
    made.kind = Distribution::Kind::uniform;
    read_ends(*all.find("uniform"), made);
  } else if (all.is("normal", "within")) {
    made.kind = Distribution::Kind::normal;
    read_normal(all, made);
  } else if (all.is("integers")) {
    made.kind = Distribution::Kind::integers;
    read_integers(*all.find("integers"), made);
  } else if (all.is("choice", "weights")) {
    made.kind = Distribution::Kind::choice;
    read_choice(*all.find("choice"), made);
    read_weights(all.find("weights"), made);
  } else {
    refuse("must name uniform, normal, integers or choice");
  }
  return made;
}

}  // namespace wobblebench::bench
