// JUnit's XML as Python's parser reads it.
#include "bench/output/junit.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "base/user_error.h"
#include "bench/command/limits.h"
#include "bench/command/run_in_folder.h"
#include "bench/results/error.h"
#include "bench/results/times.h"
#include "tests/support/process.h"

namespace wobblebench::bench {
namespace {

/// What a Python program prints of the XML, which it parses as `suite`.
std::string python(const std::string& xml, const std::string& program) {
  const testing_support::ScratchFolder folder;
  const auto file = folder.write("junit.xml", xml);
  const std::string line = "python3 -c 'import xml.etree.ElementTree as e; s=e.parse(\"" +
                           file.string() + "\").getroot()[0]; " + program + "'";
  std::FILE* pipe = ::popen(line.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0) << xml;
  return text;
}

const std::vector<Check> kCases = {
    {.group = "a", .name = "holds", .output = "x = 1"},
    {.group = "a", .name = "x<=2 & \"y\"\n", .failure = "3 > 2 \x01\xff"},
    {.name = "waits", .skipped = "no card"}};

TEST(JUnit, CountsWhatFailedAndWasSkipped) {
  const std::string counts =
      "print(*[s.get(k) for k in "
      "(\"name\",\"tests\",\"failures\",\"errors\",\"skipped\")])";
  EXPECT_EQ(python(junit_xml("bench", kCases), counts), "bench 3 1 0 1\n");
  EXPECT_EQ(python(junit_xml("none", {}), "print(len(s))"), "0\n");
}

TEST(JUnit, KeepsAnyText) {
  const std::string xml = junit_xml("bench", kCases);
  EXPECT_EQ(python(xml, "print(ascii([c.get(\"name\") for c in s]))"),
            "['holds', 'x<=2 & \"y\"\\n', 'waits']\n");
  EXPECT_EQ(python(xml, "print(ascii(s[1].find(\"failure\").get(\"message\")))"),
            "'3 > 2 \\ufffd\\ufffd'\n");
  EXPECT_EQ(python(xml, "print([c.get(\"classname\") for c in s], s[0].find(\"system-out\").text)"),
            "['bench.a', 'bench.a', 'bench'] x = 1\n");
}

TEST(Limits, AreCheckedByMagnitudeAndFailWhereNothingIsFormed) {
  const std::vector<std::string> names = {"bias_mm", "p95_mm"};
  const auto limits = parse_limits({"bias_mm<=0.5", "p95_mm<=2", "p95_mm<=1e-1"}, names);
  CommandResult result;
  Measurements found;
  found.add(error::kBias, -0.6);
  found.add(error::kP95, 0.1);
  check_limits(limits, found, result);
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_EQ(result.failure, "--limit bias_mm<=0.5: bias_mm is -0.6");
  ASSERT_EQ(result.checks.size(), 3U);
  EXPECT_TRUE(result.checks[1].failure.empty());
  EXPECT_EQ(result.checks[0].value, -0.6);
  EXPECT_EQ(result.checks[1].limit, 2);
  CommandResult unknown;
  Measurements none;
  none.because("no truth");
  none.add(error::kBias, 0.0);
  none.add(error::kP95, std::stod("nan"));
  check_limits(limits, none, unknown);
  EXPECT_EQ(unknown.failure,
            "--limit p95_mm<=2: p95_mm is not formed: no truth\n"
            "--limit p95_mm<=0.1: p95_mm is not formed: no truth");
}

TEST(Limits, NameFiguresThatSeveralPartsHaveByTheirPart) {
  Measurements found;
  found.prefix("age_oldest");
  found.add(times::kP99, 40.0);
  found.prefix("age_newest");
  found.add(times::kP99, 30.0);
  found.add(times::kN, 7);
  EXPECT_EQ(limit_names(found),
            (std::vector<std::string>{"age_oldest_p99_ms", "age_newest_p99_ms"}));
  EXPECT_EQ(to_json(found).dump(),
            R"({"age_oldest_p99_ms":40.0,"age_newest_p99_ms":30.0,"age_newest_n":7})");
}

/// What a line says that refuses the limit of a figure of this name.
std::string refusal_of(const std::string& name) {
  try {
    parse_limits({name + "<=1"}, {"p95_mm", "age_oldest_p99_ms", "age_newest_p99_ms", "ssim"});
  } catch (const UserError& error) {
    return error.what();
  }
  return "taken";
}

TEST(Limits, OfUnknownFiguresNameTheNearest) {
  const std::string all = ": must be one of p95_mm, age_oldest_p99_ms, age_newest_p99_ms, ssim";
  EXPECT_EQ(
      refusal_of("age_p99_ms"),
      "--limit = age_p99_ms" + all + "; did you mean age_oldest_p99_ms or age_newest_p99_ms?");
  EXPECT_EQ(refusal_of("p95"), "--limit = p95" + all + "; did you mean p95_mm?");
  EXPECT_EQ(refusal_of("p96_mm"), "--limit = p96_mm" + all + "; did you mean p95_mm?");
  EXPECT_EQ(refusal_of("speed"), "--limit = speed" + all);
  EXPECT_EQ(refusal_of("ssim"), "taken");
}

const std::vector<Check> kAsked = {{.group = "run", .name = "volume"},
                                   {.name = "p95_mm<=2",
                                    .output = "p95_mm = 1.5",
                                    .asked = "--limit p95_mm<=2",
                                    .limit = 2,
                                    .value = 1.5},
                                   {.name = "no stick is lost",
                                    .failure = "3 of 9 sticks were lost",
                                    .asked = "--fail-on-loss",
                                    .limit = 0,
                                    .value = 3},
                                   {.name = "waits", .skipped = "no card"}};

TEST(Checks, SayInTheReportWhatWasAskedAndFoundAndWhetherItHeld) {
  const auto json = to_json(kAsked);
  EXPECT_EQ(json.at(0).dump(),
            R"({"name":"volume","asked":null,"limit":null,"value":null,"held":true,)"
            R"("because":null})");
  EXPECT_EQ(json.at(1).dump(),
            R"({"name":"p95_mm<=2","asked":"--limit p95_mm<=2","limit":2.0,"value":1.5,)"
            R"("held":true,"because":null})");
  EXPECT_EQ(json.at(2).at("held"), false);
  EXPECT_EQ(json.at(2).at("because"), "3 of 9 sticks were lost");
  EXPECT_TRUE(json.at(3).at("held").is_null());
}

TEST(Checks, LeadAPageByWhatFailed) {
  EXPECT_EQ(verdict_text(kAsked),
            "- **Failed**: `--fail-on-loss`: 3 of 9 sticks were lost\n"
            "- Holds: `--limit p95_mm<=2`: p95_mm = 1.5\n");
  EXPECT_EQ(verdict_text({kAsked[0]}), "");
}

}  // namespace
}  // namespace wobblebench::bench
