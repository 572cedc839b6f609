// `run --tolerance`: the first settings of a ladder, from the fastest on, that keep the depth error
// of one scene within a bound, measured on that scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/measures/picture_measures.h"
#include "bench/results/error.h"
#include "bench/studies/trade/trade_analysis.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// What a tolerance bounds: P95 of the depth error's magnitude more than 3 mm from a silhouette, mm
/// (at a silhouette depth jumps, so that half a pixel costs centimetres), with at most
/// kMostWrongPercent of the picture missed or false.
inline constexpr const char* kToleranceMeasure = error::kOutsideP95.key;
inline constexpr const char* kWrongMeasure = error::kMissedOrFalse.key;

/// "0.5mm" in mm. Throws UserError "--tolerance = TEXT: what is allowed".
double parse_tolerance_mm(const std::string& text);

/// A scene file and settings, as `run` takes them.
struct ToleranceRequest {
  double tolerance_mm = 0;
  std::filesystem::path file;         ///< empty: the defaults
  std::vector<std::string> settings;  ///< section.key=value
  std::string machine;                ///< CPU and renderer: measured times are of one machine
};

/// One setting of the ladder on the scene.
struct ToleranceSetting {
  std::string text;  ///< "key = value, ...", without the rung
  TradeScore score;
  bool holds = false;  ///< a further seed is within the tolerance with a probability of 95 %
};

/// A rung of the simulator with the chosen setting.
struct ToleranceRung {
  std::string name;
  /// kToleranceMeasure on this rung less that on the finest, of the same seeds.
  MeanInterval difference_mm;
  bool agrees = false;  ///< within a quarter of the tolerance, interval included, and it holds
};

struct ToleranceChoice {
  ToleranceRequest request;
  std::vector<std::uint64_t> seeds;        ///< without the scene's own
  std::string finest_rung;                 ///< the one that the settings were measured on
  std::vector<ToleranceSetting> settings;  ///< measured, without those that the scene refuses
  std::size_t chosen = 0;
  bool promised = false;                    ///< `chosen` holds; false: it is the most accurate one
  std::vector<ToleranceRung> rungs;         ///< that were compared, the coarsest first
  std::string rung;                         ///< chosen
  std::vector<std::string> scene_settings;  ///< section.key=value of setting and rung
  bool kept = false;                        ///< read from the cache: nothing was measured

  const ToleranceSetting& setting() const { return settings[chosen]; }
};

/// Throws UserError where the scene cannot be read, or names what a tolerance chooses.
void check_request(const ToleranceRequest& request);

/// Keys that the scene names itself stay as they are. Throws UserError, and std::runtime_error
/// where every setting is refused.
ToleranceChoice choose_for_tolerance(const ToleranceRequest& request,
                                     render::GlContext& context,
                                     PhantomCache& cache,
                                     const PartDone& done = {});

/// What a picture reached.
struct ToleranceOutcome {
  double reached_mm = 0;  ///< kToleranceMeasure; NaN: no such surface
  double wrong_percent = 0;
  bool held = false;
};
ToleranceOutcome tolerance_outcome(const ToleranceChoice& choice, const PictureMeasures& measures);

}  // namespace wobblebench::bench
