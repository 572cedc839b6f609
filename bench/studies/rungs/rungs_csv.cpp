#include <sstream>

#include "base/number_text.h"
#include "bench/studies/rungs/rungs_report.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr int kDigits = 9;

/// Lines of the file.
class Rows {
 public:
  void add(const std::string& table,
           const std::string& body,
           const std::string& rung,
           std::string what,
           double value,
           const std::string& unit) {
    for (char& c : what) c = c == ',' ? ' ' : c;
    text_ << table << "," << body << "," << rung << "," << what << ","
          << significant(value, kDigits) << "," << unit << "\n";
  }
  void add(const std::string& table,
           const std::string& body,
           const std::string& rung,
           const std::string& what,
           const Spread& ms) {
    add(table, body, rung, what + "_median", ms.median, "ms");
    add(table, body, rung, what + "_min", ms.min, "ms");
    add(table, body, rung, what + "_max", ms.max, "ms");
  }
  std::string text() const { return "table,body,rung,what,value,unit\n" + text_.str(); }

 private:
  std::ostringstream text_;
};

void add_times(const RungsResults& results, Rows& rows) {
  for (const RungTime& time : results.times) {
    const std::string rung = sim::to_string(time.rung);
    rows.add("time", results.phantom, rung, "map", time.map_ms);
    rows.add("time", results.phantom, rung, "once", time.once_ms);
    rows.add("time", results.phantom, rung, "first", time.first_ms);
    rows.add("time", results.phantom, rung, "still", time.still_ms);
    rows.add("time", results.phantom, rung, "moving", time.moving_ms);
    rows.add("time", results.phantom, rung, "bending", time.bending_ms);
  }
  for (const StageTimes& stages : results.stages) {
    const std::string rung = sim::to_string(stages.rung);
    rows.add("stage", results.phantom, rung, "once", stages.once_ms, "ms");
    for (const auto& [name, ms] : stages.stages) {
      rows.add("stage", results.phantom, rung, name, ms, "ms");
    }
    rows.add("stage",
             results.phantom,
             rung,
             "echoes of scatterers",
             static_cast<double>(stages.scatterers),
             "1");
  }
}

void add_depth(const RungError& error,
               const std::string& against,
               const RangeError& spread,
               Rows& rows) {
  const std::string rung = sim::to_string(error.rung);
  rows.add("error", error.body, rung, against + " median", spread.median_mm, "mm");
  rows.add("error", error.body, rung, against + " median size", spread.median_abs_mm, "mm");
  rows.add("error", error.body, rung, against + " p95 size", spread.p95_abs_mm, "mm");
  rows.add("error", error.body, rung, against + " missed", spread.missed_percent, "%");
  rows.add("error", error.body, rung, against + " sticks", static_cast<double>(spread.n), "1");
}

void add_errors(const RungsResults& results, Rows& rows) {
  for (const RungError& error : results.errors) {
    const std::string rung = sim::to_string(error.rung);
    add_depth(error, "truth", error.against_truth, rows);
    if (error.against_above) add_depth(error, "above", *error.against_above, rows);
    if (!error.image_rms_db) continue;
    rows.add("error", error.body, rung, "above image rms", *error.image_rms_db, "dB");
    rows.add("error", error.body, rung, "above image correlation", *error.image_correlation, "1");
  }
}

}  // namespace

std::string rungs_csv(const RungsResults& results) {
  Rows rows;
  add_times(results, rows);
  for (const GrowthPoint& point : results.growth) {
    const std::string rung = sim::to_string(point.rung),
                      what = point.what + "=" + significant(point.size, kDigits);
    rows.add("growth", "block", rung, what + " first", point.time.first_ms);
    rows.add("growth", "block", rung, what + " moving", point.time.moving_ms);
  }
  add_errors(results, rows);
  for (const MemoryPeak& peak : results.memory) {
    rows.add("memory", results.phantom, "", peak.what, peak.bytes, "bytes");
  }
  return rows.text();
}

}  // namespace wobblebench::bench
