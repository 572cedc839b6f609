// report.html: what comes from outside is text, and nothing else can run or load.
#include "bench/output/page/page.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "bench/output/page/page_text.h"
#include "bench/output/page/report_page.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

constexpr const char* kHostile =
    "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&";

std::string page_of(const Document& document) {
  return html(document, [](const std::string& file) { return "bytes of " + file; });
}

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(PageText, MarkupIsShownAsText) {
  EXPECT_EQ(escaped("<a href=\"x\">'&'</a>"),
            "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
  EXPECT_EQ(escaped("\xff\x01 \xc3\xa9"), "\xef\xbf\xbd\xef\xbf\xbd \xc3\xa9");
}

TEST(PageText, KnowsParagraphsListsCodeAndLinks) {
  EXPECT_EQ(html_of_markdown("One `a<b`\nline.\n\n- **x**\n- [y](z.csv)\n"),
            "<p>One <code>a&lt;b</code>\nline.</p>\n"
            "<ul>\n<li><strong>x</strong></li>\n<li><a href=\"z.csv\">y</a></li>\n</ul>\n");
  EXPECT_EQ(html_of_markdown("[a](javascript:alert(1))"), "<p>a)</p>\n");
  EXPECT_EQ(html_of_markdown("[a](//host/x) 2 ** 3 and `open"), "<p>a 2 ** 3 and `open</p>\n");
}

/// Of RFC 4648, section 10.
TEST(PageText, Base64OfTheStandardsExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(Page, NothingOfADocumentIsMarkup) {
  Chart chart{kHostile, {kHostile}, {kHostile}};
  chart.series.push_back({.name = kHostile, .x = {1}, .y = {1}, .ids = {kHostile}});
  Table table{.name = kHostile, .caption = kHostile, .columns = {{kHostile, kHostile, kHostile}}};
  table.add({kHostile}, kHostile);
  Document document{.title = kHostile};
  document.add(Heading{kHostile})
      .add(Text{kHostile})
      .add(table)
      .add(Figure{"c", kHostile, {chart}})
      .add(Picture{"p.png", kHostile})
      .add(PicturePair{{"l.png", kHostile}, {"r.png", kHostile}})
      .add(MapView{.name = "m", .caption = kHostile, .layers = {{.name = kHostile}}})
      .add(Detail{kHostile, kHostile, kHostile, kHostile, "d.png"})
      .add(Listing{kHostile, kHostile})
      .add(CommandLine{kHostile});
  const std::string page = page_of(document), plain = page_of({.title = "plain"});
  EXPECT_EQ(count(page, "alert(1)</script>"), 0);
  EXPECT_EQ(count(page, "<img src=x"), 0);
  // Data of the chart and of the map, and at most the script that draws charts.
  EXPECT_LE(count(page, "<script"), count(plain, "<script") + 3);
  EXPECT_EQ(count(page, "<script"), count(page, "</script>"));
}

TEST(Page, RandomBytesNeverEndItsElements) {
  std::mt19937 random(1);
  const std::string alphabet = "<>/!-\"'&`*[]()script \n\xc3\xa9\xff";
  for (int i = 0; i < 2000; ++i) {
    std::string text;
    for (auto length = random() % 40; length > 0; --length) {
      text += alphabet[random() % alphabet.size()];
    }
    const std::string shown = html_of_markdown(text);
    EXPECT_EQ(count(shown, "<script"), 0) << text;
    for (const char* element : {"p", "li", "code", "strong", "a", "ul"}) {
      const std::string name = element;
      EXPECT_EQ(count(shown, "<" + name + ">") + count(shown, "<" + name + " href"),
                count(shown, "</" + name + ">"))
          << text;
    }
  }
}

TEST(Page, ThePolicyNamesHashesAndNoNetwork) {
  const std::string page = page_of({.title = "plain"});
  EXPECT_TRUE(holds(page, "default-src 'none'; img-src data: blob:; style-src 'sha256-"));
  EXPECT_FALSE(holds(page, "unsafe"));
  EXPECT_TRUE(holds(page, "<html lang=\"en\">"));
}

TEST(Page, PicturesAreInsideIt) {
  Document document{.title = "one"};
  document.add(Picture{"foo", "A caption."});
  const std::string page = html(document, [](const std::string&) { return "foobar"; });
  EXPECT_TRUE(holds(page, "<img src=\"data:image/png;base64,Zm9vYmFy\" alt=\"A caption.\">"));
}

TEST(Page, SaysThatAPictureIsCompressed) {
  Document document{.title = "x"};
  document.add(Picture{"large.png", "A face."});
  const std::string page = html(document, [](const std::string&) { return "\xff\xd8\xff"; });
  EXPECT_EQ(count(page, "src=\"data:image/jpeg;base64,/9j/\""), 1);
  EXPECT_EQ(count(page, "A face. Compressed on this page; large.png is exact."), 1);
}

TEST(ReportPage, BeginsWithTheAnswerAndThenWarns) {
  Document document{.title = "run"};
  document.add(Text{"Failed: a limit"})
      .add(KeyFigures().add("P95", 1.314, "p95_mm", "Of the error", true).add("bias", NAN, "", ""))
      .add(Text{"The rest"});
  const std::string page = report_page(
      document, R"({"warnings": ["few sticks"]})", "", [](const std::string&) { return ""; });
  std::size_t last = page.find("</head>");
  for (const char* part : {"Failed: a limit",
                           "class=\"failed\"",
                           "<strong>1.31</strong> mm",
                           "few sticks",
                           "The rest"}) {
    const std::size_t at = page.find(part);
    ASSERT_NE(at, std::string::npos) << part;
    EXPECT_GT(at, last) << part;
    last = at;
  }
}

TEST(ReportPage, SaysWhatTheCommandWarnedOfAndHowItWasMade) {
  const std::string page = report_page({.title = "run"},
                                       R"({"provenance": {"cpu": "a CPU", "load": {"x": 1}},
                                           "warnings": ["too <few> sticks"],
                                           "scene": {"render": {"mode": "surface"}},
                                           "timing": {"wall_ms": {"stream": 62}}})",
                                       "wobblebench run 'a b.toml'",
                                       [](const std::string&) { return ""; });
  for (const char* part : {"too &lt;few&gt; sticks",
                           "wobblebench run &#39;a b.toml&#39;",
                           "a CPU",
                           "<code>load.x</code>",
                           "<td>stream</td><td class=\"number\" data-value=\"62\">62</td>",
                           "&quot;mode&quot;: &quot;surface&quot;"}) {
    EXPECT_TRUE(holds(page, part)) << part;
  }
}

}  // namespace
}  // namespace wobblebench::bench
