// An axis of a chart: its range, its ticks and their labels.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace wobblebench::bench {

enum class Scale { linear, logarithmic };

struct Tick {
  double value = 0;
  std::string text;
};

struct Axis {
  std::string label;  ///< with its unit: "range (mm)"
  Scale scale = Scale::linear;
  /// Ends; from the data unless given.
  std::optional<double> low;
  std::optional<double> high;
  std::vector<Tick> ticks;  ///< round numbers unless given
};

/// An axis with known ends.
class Ruler {
 public:
  /// Ends that the axis leaves open follow from `values` (those that are finite and, on a
  /// logarithmic axis, positive), with a small margin beyond them. Throws std::invalid_argument
  /// where nothing can be shown.
  Ruler(const Axis& axis, const std::vector<double>& values);

  double low() const { return low_; }
  double high() const { return high_; }
  bool contains(double value) const { return value >= low_ && value <= high_; }
  /// Position along the axis: 0 at the low end, 1 at the high one.
  double fraction(double value) const;
  /// The axis's own, or else at 1, 2 or 5 times a power of ten, at most about `most` of them.
  std::vector<Tick> ticks(int most) const;

 private:
  std::vector<Tick> linear_ticks(int most) const;
  std::vector<Tick> logarithmic_ticks(int most) const;

  Scale scale_;
  std::vector<Tick> ticks_;  ///< given
  double low_;
  double high_;
};

}  // namespace wobblebench::bench
