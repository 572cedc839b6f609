#include "base/text.h"

#include <gtest/gtest.h>

#include <string>

namespace wobblebench {
namespace {

using namespace std::string_literals;

TEST(Utf8, LengthIsThatOfTheFirstSequence) {
  EXPECT_EQ(utf8_length("a"), 1u);
  EXPECT_EQ(utf8_length("\x7f"), 1u);
  EXPECT_EQ(utf8_length("\xc2\x80 "), 2u);          // U+0080
  EXPECT_EQ(utf8_length("\xdf\xbf"), 2u);           // U+07FF
  EXPECT_EQ(utf8_length("\xe0\xa0\x80"), 3u);       // U+0800
  EXPECT_EQ(utf8_length("\xef\xbf\xbf"), 3u);       // U+FFFF
  EXPECT_EQ(utf8_length("\xf0\x90\x80\x80z"), 4u);  // U+10000
  EXPECT_EQ(utf8_length("\xf4\x8f\xbf\xbf"), 4u);   // U+10FFFF
}

TEST(Utf8, RejectsWhatRfc3629Excludes) {
  for (const std::string& text : {"\x80"s,              // continuation byte alone
                                  "\xc0\xaf"s,          // overlong
                                  "\xc1\xbf"s,          // overlong
                                  "\xe0\x9f\xbf"s,      // overlong
                                  "\xf0\x8f\xbf\xbf"s,  // overlong
                                  "\xed\xa0\x80"s,      // surrogate U+D800
                                  "\xed\xbf\xbf"s,      // surrogate U+DFFF
                                  "\xf4\x90\x80\x80"s,  // U+110000
                                  "\xf5\x80\x80\x80"s,  // no such first byte
                                  "\xff"s,              // no such byte
                                  "\xc3"s,              // truncated
                                  "\xe2\x82"s,          // truncated
                                  "\xf0\x90\x80"s,      // truncated
                                  "\xe2\x28\xa1"s,      // second byte is no continuation
                                  "\xe2\x82\x28"s}) {   // third byte is no continuation
    EXPECT_EQ(utf8_length(text), 0u) << testing::PrintToString(text);
    EXPECT_FALSE(is_utf8(text));
    EXPECT_FALSE(is_utf8("ok " + text));
  }
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(is_utf8("caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80"));
}

TEST(Text, ControlCharactersAreTheAsciiOnes) {
  EXPECT_TRUE(is_control('\0'));
  EXPECT_TRUE(is_control('\n'));
  EXPECT_TRUE(is_control('\x1f'));
  EXPECT_TRUE(is_control('\x7f'));
  EXPECT_FALSE(is_control(' '));
  EXPECT_FALSE(is_control('~'));
  EXPECT_FALSE(is_control('\x80'));
}

TEST(Text, IsPrintableWithoutControlCharacters) {
  EXPECT_TRUE(
      is_printable_text("Wharton's jelly, 37 \xc2\xb0"
                        "C"));
  EXPECT_TRUE(is_printable_text(""));
  EXPECT_FALSE(is_printable_text("a\nb"));
  EXPECT_FALSE(is_printable_text("a\0b"s));
  EXPECT_FALSE(is_printable_text("\xff"));
}

TEST(CsvField, IsQuotedWhereRfc4180AsksForIt) {
  EXPECT_EQ(csv_field("plain text"), "plain text");
  EXPECT_EQ(csv_field("1,5"), "\"1,5\"");
  EXPECT_EQ(csv_field("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(csv_field("two\nlines"), "\"two\nlines\"");
}

TEST(ShellWord, NamesEveryTextAsOneWord) {
  EXPECT_EQ(shell_word("out/recording.wbst"), "out/recording.wbst");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("my out"), "'my out'");
  EXPECT_EQ(shell_word("a$(touch x)`y`"), "'a$(touch x)`y`'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word("\xc3\xa9"), "'\xc3\xa9'");
}

}  // namespace
}  // namespace wobblebench
