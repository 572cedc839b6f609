// The measurements of the command `trade`: time and error of every point of a plan.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cache/watched_files.h"
#include "bench/studies/trade/trade_journal.h"
#include "bench/studies/trade/trade_plan.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// A plan with its points, and the scenes that they make.
struct TradeWork {
  TradePlan plan;
  std::vector<TradePoint> points;
  std::vector<std::string> more;  ///< settings for all, after those of the scene

  /// The scene as a point sets it. Throws UserError.
  Scene scene(std::size_t scene, const TradePoint& point) const;
  /// What is set in the scene's file for a point that has these settings.
  std::vector<std::string> settings(std::size_t scene,
                                    const std::vector<std::string>& of_point) const;
  Scene reference(std::size_t scene) const;
  /// The scene with these settings in place of a point's; none where it is refused.
  std::optional<Scene> without_point(std::size_t scene,
                                     const std::vector<std::string>& others = {}) const;
  /// The command that makes the picture of a point on a scene, with the plan's first seed.
  std::string run_command(std::size_t scene, std::size_t point) const;
  /// The files that scenes and axes name, in the order of the plan.
  std::vector<std::filesystem::path> files() const;
  /// A hash of all that the records follow from: of files the content, and not the name. Throws as
  /// read_pieces().
  std::string hash() const;
};

/// Reads each scene with its reference, and with each level of each axis alone. Throws UserError.
void check_trade(const TradeWork& work);

/// Leaves out the scenes of a population that cannot be built, as an identity whose measures no
/// face has, and returns a line for each. Phantoms are made once, and kept by the cache. Throws
/// UserError where none is left.
std::vector<std::string> leave_out_refused(TradeWork& work,
                                           PhantomCache& cache,
                                           const PartDone& done = {});

/// One line that names the settings of plan and scenes that are without effect in every point of
/// the design; empty: there are none.
std::string idle_settings(const TradeWork& work);

/// Every measurement, in the order of the work: what shares sticks and slices follows each other.
std::vector<TradeUnit> trade_units(const TradeWork& work);

/// Part `index` of `count`, from 1 on: a stretch of the work.
std::vector<TradeUnit> trade_shard(const std::vector<TradeUnit>& units, int index, int count);

/// Measures what is not in the journal yet. A combination of settings that the scene, the simulator
/// or the renderer refuses is a record that says so.
void measure_trade(const TradeWork& work,
                   const std::vector<TradeUnit>& units,
                   TradeJournal& journal,
                   render::GlContext& context,
                   PhantomCache& cache,
                   const PartDone& done = {});

/// Keeps sticks, truth and slices from one measurement to the next where both need the same.
class TradeMeasurement {
 public:
  /// `kept`: the most scans that are kept, and the most references; 1 suffices where the units come
  /// in the order of trade_units(). `work` may get more points meanwhile.
  TradeMeasurement(const TradeWork& work,
                   render::GlContext& context,
                   PhantomCache& cache,
                   std::size_t kept = 1);
  ~TradeMeasurement();

  /// A combination that is refused makes a record that says so. Throws std::runtime_error, and
  /// UserError where a file of the plan has changed since this was made.
  TradeRecord measure(const TradeUnit& unit);
  /// The surface as it is shown, in linear light. Throws as Evaluator does.
  Image<glm::vec3> picture(const TradeUnit& unit);

 private:
  struct Scan;
  struct Reference;

  Scan& scan_of(const TradeUnit& unit, const Scene& scene);
  Reference& reference_of(std::size_t scene);
  void measure(const TradeUnit& unit, const Scene& scene, TradeRecord& record);

  const TradeWork& work_;
  render::GlContext& context_;
  PhantomCache& cache_;
  std::size_t kept_;
  WatchedFiles files_;                       ///< that the plan names
  std::deque<std::unique_ptr<Scan>> scans_;  ///< the last used is last
  std::map<std::size_t, std::unique_ptr<Reference>> references_;
};

}  // namespace wobblebench::bench
