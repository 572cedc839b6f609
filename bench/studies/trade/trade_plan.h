// The plan of the command `trade`: scenes, axes of settings, and how the axes are sampled.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/studies/accuracy/accuracy_plan.h"

namespace wobblebench::bench {

/// How points are chosen. `grid`: every combination of levels. `latin_hypercube`: each level of
/// each axis equally often, in random combinations. `sobol`: a low-discrepancy sequence.
enum class TradeDesign { grid, latin_hypercube, sobol };

/// One setting and what it is set to.
struct TradeAxis {
  std::string key;  ///< section.key of a scene
  /// As in TOML. A range has its quarters, for which effects are computed.
  std::vector<std::string> levels;
  struct Range {
    double from = 0, to = 0;
    bool logarithmic = false;
  };
  std::optional<Range> range;  ///< values between two numbers; not in a grid

  bool is_of_files() const;  ///< its values are names of files
};

/// In TOML:
///   design = "latin_hypercube"              # or "sobol", "grid"
///   points = 500                            # not of a grid
///   design_seed = 1
///   seeds = 3                               # each point is measured on 3 seeds
///   first_seed = 1
///   repeats = 3                             # of the times
///   [reference.render]                      # the setting whose time is 1, over each scene
///   preset = "baseline"
///   [scenes.face]                           # as in a plan of `accuracy`
///   [unseen.plane.phantom]                  # likewise; `tune` measures its choice on them
///   name = "plane"
///   population = "population.toml"          # in place of scenes and unseen (DrawnOptions), half
///                                           # "train" of it unless the plan says; unseen: the
///                                           other
///   [axes]
///   "render.ray_casting.steps" = [128, 256, 512]
///   "render.ray_casting.iso_level" = { from = 0.5, to = 0.9 }
///   "render.reconstruction.spacing_mm" = { from = 0.5, to = 4, logarithmic = true }
struct TradePlan {
  std::string source;  ///< the file, for refusals
  TradeDesign design = TradeDesign::grid;
  int points = 0;
  std::uint64_t design_seed = 1;
  std::vector<std::uint64_t> seeds;
  int repeats = 3;
  std::vector<NamedOptions> scenes;
  std::vector<NamedOptions> unseen;  ///< scenes on which `tune` judges what it found
  /// Of each scene and of each unseen one, where a population draws them; else empty.
  std::vector<std::string> strata, unseen_strata;
  NamedOptions reference;
  std::vector<TradeAxis> axes;
  /// The scene may have a seed of its own, and several volumes, of which the first is measured.
  bool of_one_scene = false;

  /// Everything that the measured points of `trade` follow from, as a text, but for the options of
  /// the scenes and the files that these name.
  std::string canonical() const;
};

/// A combination of values: for each axis the value, as in TOML, and the number of its level.
struct TradePoint {
  std::vector<std::string> values;
  std::vector<int> levels;

  bool operator==(const TradePoint&) const = default;
};

inline constexpr int kMostTradePoints = 1000000;

/// Throws UserError "FILE: key = value: what is allowed". What the settings hold is not yet
/// checked.
TradePlan load_trade_plan(const std::filesystem::path& path);

/// The points of the plan, in its order; the same each time.
std::vector<TradePoint> design_points(const TradePlan& plan);

/// The point at a share of each axis, from 0 to 1. Throws std::invalid_argument for another number
/// of axes.
TradePoint point_at(const TradePlan& plan, const std::vector<double>& shares);
/// A share of each axis from which point_at() makes the point again.
std::vector<double> shares_of(const TradePlan& plan, const TradePoint& point);

/// The number of each scene of the plan.
std::vector<std::size_t> all_scenes(const TradePlan& plan);

/// The settings of a point, as load_scene() takes them.
std::vector<std::string> settings_of(const TradePlan& plan, const TradePoint& point);

}  // namespace wobblebench::bench
