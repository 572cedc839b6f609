// JUnit's XML as Python's parser reads it.
#include "bench/output/junit.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "bench/command/limits.h"
#include "bench/command/run_in_folder.h"
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

const std::vector<TestCase> kCases = {
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
  check_limits(limits, {{"bias_mm", -0.6}, {"p95_mm", 0.1}}, result);
  EXPECT_EQ(result.exit_code, kFailed);
  EXPECT_EQ(result.failure, "--limit bias_mm<=0.5: bias_mm is -0.6");
  ASSERT_EQ(result.checks.size(), 3U);
  EXPECT_TRUE(result.checks[1].failure.empty());
  CommandResult unknown;
  check_limits(limits, {{"bias_mm", 0}, {"p95_mm", std::stod("nan"), "no truth"}}, unknown);
  EXPECT_EQ(unknown.failure,
            "--limit p95_mm<=2: p95_mm is not formed: no truth\n"
            "--limit p95_mm<=0.1: p95_mm is not formed: no truth");
}

}  // namespace
}  // namespace wobblebench::bench
