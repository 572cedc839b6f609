// Measures one point on one scene and seed.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "bench/studies/trade/trade_study.h"

namespace wobblebench::bench {

/// The values of the axes that decide which sticks are made, as one text.
std::string scan_values(const TradePlan& plan, const TradePoint& point);
/// Those that decide which slices a renderer makes of them.
std::string slice_values(const TradePlan& plan, const TradePoint& point);

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

  /// A combination that is refused makes a record that says so. Throws std::runtime_error.
  TradeRecord measure(const TradeUnit& unit);

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
  std::deque<std::unique_ptr<Scan>> scans_;  ///< the last used is last
  std::map<std::size_t, std::unique_ptr<Reference>> references_;
};

}  // namespace wobblebench::bench
