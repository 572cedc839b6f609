// What report.html and ages.csv of `stream` make of a stream's records.
#include "bench/cli/stream/stream_page.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace wobblebench::bench {
namespace {

using std::chrono::milliseconds;

/// A picture of a volume whose first stick was fired at `fired_ms` and its last 400 ms later, and
/// which is ready `age_ms` after the first.
PictureTimes picture(hw::HostTime begin, std::uint32_t volume, int fired_ms, int age_ms) {
  PictureTimes times{.volume = volume, .sticks = 10, .lost = 1};
  times.first.fired = begin + milliseconds(fired_ms);
  times.first.received = begin + milliseconds(fired_ms + 1);
  times.last.fired = begin + milliseconds(fired_ms + 400);
  times.last.arrived = false;
  times.complete = times.taken = begin + milliseconds(fired_ms + 402);
  times.update_ms = 2.5;
  times.passes = {{.name = "ray_casting", .ms = 30}, {.name = "scan_conversion", .ms = 9}};
  times.ready = begin + milliseconds(fired_ms + age_ms);
  times.written = times.ready + milliseconds(5);
  return times;
}

StreamReport report_of_three() {
  StreamReport report;
  report.result.begin = hw::HostTime(milliseconds(1000));
  report.summary.scheduled = true;
  report.result.records = {picture(report.result.begin, 0, 0, 500),
                           picture(report.result.begin, 1, 450, 700),
                           picture(report.result.begin, 3, 1350, 600)};
  return report;
}

TEST(StreamPage, DrawsAgesAndWhatWasNotShown) {
  const Chart chart = std::get<Chart>(ages_figure(report_of_three()).panels.at(0));
  ASSERT_EQ(chart.series.size(), 3u);
  const Series &oldest = chart.series[0], &newest = chart.series[1];
  EXPECT_EQ(oldest.x, (std::vector<double>{0, 1, 2, 3}));
  EXPECT_EQ(oldest.y[1], 700);
  EXPECT_TRUE(std::isnan(oldest.y[2])) << "a gap";
  EXPECT_EQ(oldest.y[3], 600);
  EXPECT_EQ(newest.y[0], 100);
  EXPECT_EQ(newest.y[3], 200);
  EXPECT_EQ(chart.series[2].x, (std::vector<double>{2}));
}

/// Columns as docs/output.md describes them; what is not known is empty.
TEST(StreamPage, AgesAreRowsOfTheirOwn) {
  EXPECT_EQ(csv(stream_ages(report_of_three())),
            "volume,whole,sticks,lost_sticks,emitted_first_ms,emitted_last_ms,arrived_first_ms,"
            "arrived_last_ms,complete_ms,taken_ms,scan_conversion_ms,ray_casting_ms,shown_ms,"
            "written_ms,age_oldest_ms,age_newest_ms\n"
            "0,1,10,1,0,400,1,,402,402,2.5,30,500,505,500,100\n"
            "1,1,10,1,450,850,451,,852,852,2.5,30,1150,1155,700,300\n"
            "3,1,10,1,1350,1750,1351,,1752,1752,2.5,30,1950,1955,600,200\n");
}

}  // namespace
}  // namespace wobblebench::bench
