// How a struct of results says what it holds. Each figure is declared once, as a Measure, and each
// struct has one function
//
//   void describe(const Result& result, Measurements& to);
//
// that names its figures with their values. report.json, tables, CSV, --limit, `compare`, the
// studies and the live page read that list.
#pragma once

#include <concepts>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace wobblebench::bench {

/// The way in which a figure gets worse.
enum class Worse { higher, lower, away_from_zero, neither };

/// A figure, whatever its value.
struct Measure {
  const char* key;    ///< with its unit at the end: "rms_mm"
  const char* title;  ///< for people, without the unit: "RMS"
  const char* help;   ///< what it is
  Worse worse = Worse::higher;
};

/// A unit, and the digits after the decimal point that people are shown of it.
struct Unit {
  std::string_view ending;  ///< of keys: "_percent"
  const char* name;         ///< for people: "%"
  int digits;
};
/// Of a key that ends with none, as "ssim": without a name.
const Unit& unit_of(std::string_view key);

/// Some figures, as the columns of a table.
using Chosen = std::span<const Measure* const>;

struct MeasuredValue {
  const Measure* measure;
  double value;         ///< NaN: not formed
  bool whole;           ///< a count
  std::string name;     ///< in report.json, --limit and CSV: its key, or "age_oldest_p99_ms"
  std::string because;  ///< why it is not formed, where that is known
};

/// Figures with their values, in the order in which they were described.
///
/// @code
/// #include "bench/evaluation/measures/depth_error.h"
/// #include "bench/results/error.h"
/// bench::Measurements found;
/// describe(bench::depth_statistics({0.001, 0.002}), found);
/// const double bias_mm = found.value(bench::error::kBias);  // 1.5
/// @endcode
class Measurements {
 public:
  /// The names of those that follow begin with this, where a struct has the same figures several
  /// times: "age_oldest" makes "age_oldest_p99_ms" of "p99_ms". Empty: their keys are their names.
  void prefix(std::string of) { prefix_ = std::move(of); }
  /// Why those that follow are not formed, if they are not.
  void because(std::string why) { because_ = std::move(why); }
  void add(const Measure& measure, double value) { add(measure, value, false); }
  template <std::integral Count>
  void add(const Measure& measure, Count count) {
    add(measure, static_cast<double>(count), true);
  }

  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }
  /// Null: not described. Of a name that several groups have, that of the first.
  const MeasuredValue* find(std::string_view name) const;
  /// NaN: not described.
  double value(const Measure& measure) const;

 private:
  void add(const Measure& measure, double value, bool whole);

  std::string prefix_, because_;
  std::vector<MeasuredValue> all_;
};

template <class Result, class... More>
Measurements described(const Result& result, const More&... more) {
  Measurements found;
  describe(result, more..., found);
  return found;
}

/// By their names; null: not formed.
nlohmann::ordered_json to_json(const Measurements& found);

}  // namespace wobblebench::bench
