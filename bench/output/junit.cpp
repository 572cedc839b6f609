#include "bench/output/junit.h"

#include <algorithm>
#include <string_view>

#include "base/text.h"

namespace wobblebench::bench {

namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";  // U+FFFD

/// A character that XML 1.0 cannot hold: control characters but tab and line ends, U+FFFE, U+FFFF.
bool is_forbidden(std::string_view character) {
  if (character.size() == 1) {
    const auto byte = static_cast<unsigned char>(character[0]);
    return byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r';
  }
  return character == "\xef\xbf\xbe" || character == "\xef\xbf\xbf";
}

std::string_view escaped(std::string_view character) {
  if (is_forbidden(character)) return kReplacement;
  if (character == "&") return "&amp;";
  if (character == "<") return "&lt;";
  if (character == ">") return "&gt;";
  if (character == "\"") return "&quot;";
  if (character == "\n") return "&#10;";  // a bare one in an attribute is read as a space
  if (character == "\t") return "&#9;";
  if (character == "\r") return "&#13;";
  return character;
}

std::string xml_text(std::string_view text) {
  std::string xml;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::size_t taken = std::max<std::size_t>(length, 1);
    xml += length == 0 ? kReplacement : escaped(text.substr(0, length));
    text.remove_prefix(taken);
  }
  return xml;
}

std::string attribute(std::string_view name, std::string_view value) {
  return std::string(" ").append(name).append("=\"").append(xml_text(value)).append("\"");
}

std::string case_xml(const std::string& suite, const Check& test) {
  std::string xml = "  <testcase";
  xml += attribute("classname", test.group.empty() ? suite : suite + "." + test.group) +
         attribute("name", test.name) + ">\n";
  if (!test.failure.empty()) {
    xml += "   <failure" + attribute("message", test.failure) + ">" + xml_text(test.failure) +
           "</failure>\n";
  } else if (!test.skipped.empty()) {
    xml += "   <skipped" + attribute("message", test.skipped) + "/>\n";
  }
  if (!test.output.empty()) {
    xml += "   <system-out>" + xml_text(test.output) + "</system-out>\n";
  }
  return xml + "  </testcase>\n";
}

}  // namespace

std::string junit_xml(const std::string& suite, const std::vector<Check>& cases) {
  const auto failed =
      std::ranges::count_if(cases, [](const auto& c) { return !c.failure.empty(); });
  const auto skipped = std::ranges::count_if(
      cases, [](const auto& c) { return c.failure.empty() && !c.skipped.empty(); });
  std::string body;
  for (const Check& test : cases) body += case_xml(suite, test);
  const std::string counts = attribute("tests", std::to_string(cases.size())) +
                             attribute("failures", std::to_string(failed)) +
                             attribute("errors", "0") +
                             attribute("skipped", std::to_string(skipped));
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n <testsuite" +
         attribute("name", suite) + counts + ">\n" + body + " </testsuite>\n</testsuites>\n";
}

}  // namespace wobblebench::bench
