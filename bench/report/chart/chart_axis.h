// An axis of a chart: its range, where its ticks lie and how they read.
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
  /// Ends; found from the data unless given.
  std::optional<double> low;
  std::optional<double> high;
  std::vector<Tick> ticks;  ///< where they are not round numbers; found unless given
};

/// An axis whose ends are known.
class Ruler {
 public:
  /// Ends that the axis leaves open follow from `values` (those that are finite and, on a
  /// logarithmic axis, positive), with a little room beyond them. Throws std::invalid_argument
  /// where nothing can be shown.
  Ruler(const Axis& axis, const std::vector<double>& values);

  double low() const { return low_; }
  double high() const { return high_; }
  bool shows(double value) const { return value >= low_ && value <= high_; }
  /// 0 at the low end, 1 at the high one.
  double share(double value) const;
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
