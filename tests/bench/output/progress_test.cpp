// Progress: what is shown, how often, and the time that is left.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <regex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/output/progress.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

using std::chrono::milliseconds;

/// Collects what is written to a FILE and flushed; any thread may write.
class Text {
 public:
  Text() : file_(std::tmpfile()) {}
  ~Text() { std::fclose(file_); }
  Text(const Text&) = delete;
  Text& operator=(const Text&) = delete;
  std::FILE* file() { return file_; }
  std::string text() const {
    std::string text(100000, '\0');
    const ssize_t size = ::pread(::fileno(file_), text.data(), text.size(), 0);
    return text.substr(0, static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  }

 private:
  std::FILE* file_;
};

ProgressOutput often(Text& to, bool terminal) {
  return {.file = to.file(),
          .terminal = terminal,
          .first = milliseconds(20),
          .every = milliseconds(20)};
}

TEST(TimeLeft, IsAsLongAsTheFinishedPartsTookForTheirShare) {
  TimeLeft left({{"a", 1}, {"b", 3}}, 0);
  left.begin("a", 0);
  EXPECT_FALSE(left.seconds(5));
  left.part(0.5, 10);  // an eighth in 10 s
  EXPECT_DOUBLE_EQ(left.seconds(10).value(), 70);
  EXPECT_DOUBLE_EQ(left.seconds(14).value(), 66);
  left.finish(16);
  left.begin("b", 16);
  EXPECT_DOUBLE_EQ(left.seconds(16).value(), 48);
  left.part(0.5, 40);  // 2.5 of 4 in 40 s
  EXPECT_DOUBLE_EQ(left.seconds(40).value(), 24);
  EXPECT_FALSE(left.seconds(70)) << "longer than was expected of all";
}

TEST(TimeLeft, StepsThatDoNotComeAreNotWaitedFor) {
  TimeLeft left({{"a", 1}, {"never", 100}, {"b", 1}}, 0);
  left.begin("a", 0);
  left.finish(10);
  EXPECT_DOUBLE_EQ(left.seconds(10).value(), 1010);
  left.begin("b", 10);
  EXPECT_DOUBLE_EQ(left.seconds(10).value(), 10);
}

TEST(TimeLeft, AStepThatIsNotPlannedHasNoShare) {
  TimeLeft left({{"a", 1}, {"b", 1}}, 0);
  left.begin("a", 0);
  left.finish(10);
  left.begin("other", 10);
  EXPECT_DOUBLE_EQ(left.seconds(12).value(), 8);
  left.finish(12);
  left.begin("b", 12);
  EXPECT_DOUBLE_EQ(left.seconds(12).value(), 12);
}

TEST(TimeLeft, WithoutAPlanItIsOfTheStep) {
  TimeLeft left({}, 0);
  left.begin("a", 100);
  left.part(0.25, 110);
  EXPECT_DOUBLE_EQ(left.seconds(110).value(), 30);
  left.finish(140);
  left.begin("b", 140);
  EXPECT_FALSE(left.seconds(150));
  left.part(0.5, 160);
  EXPECT_DOUBLE_EQ(left.seconds(160).value(), 20);
}

/// A step that waits until it has been shown `times` times.
void show(Text& out, bool terminal, const std::string& line, int times) {
  Progress progress({{"measure", 1}, {"draw", 1}}, often(out, terminal));
  progress.step("measure", [&](const PartDone& done) {
    std::this_thread::sleep_for(milliseconds(1000));  // of which the time left is estimated
    done(3, 4);
    done(2, 4);  // of a thread that was overtaken
    progress.note("2 lost");
    const std::regex pattern(line);
    for (int waited = 0; waited < 500; ++waited) {
      const std::string text = out.text();
      const auto found = std::distance(std::sregex_iterator(text.begin(), text.end(), pattern),
                                       std::sregex_iterator());
      if (found >= times) return;
      std::this_thread::sleep_for(milliseconds(20));
    }
    FAIL() << out.text();
  });
}

constexpr const char* kLine = "measure: 3 of 4, 2 lost, [0-9]+ s, about [0-9]+ s left";

TEST(Progress, IsALineEveryWhileInALog) {
  Text out;
  show(out, false, std::string("(^|\n)") + kLine + "\n", 1);
  EXPECT_TRUE(std::regex_search(out.text(), std::regex("\nmeasure +[0-9]+ ms\n$"))) << out.text();
  EXPECT_FALSE(holds(out.text(), "\x1b"));
}

TEST(Progress, IsOneLineOnATerminal) {
  Text out;
  show(out, true, std::string("\r\x1b\\[K") + kLine, 3);
  const std::string text = out.text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_TRUE(std::regex_search(text, std::regex("\r\x1b\\[Kmeasure +[0-9]+ ms\n$"))) << text;
}

TEST(Progress, AStepThatEndsSoonIsOneLine) {
  Text out;
  Progress progress({}, {.file = out.file(), .first = milliseconds(60000)});
  EXPECT_EQ(progress.step("sum", [] { return 5; }), 5);
  EXPECT_TRUE(std::regex_match(out.text(), std::regex("sum +[0-9]+ ms\n"))) << out.text();
  ASSERT_EQ(progress.steps().size(), 1U);
  EXPECT_EQ(progress.times().back().first, "total");
}

TEST(Progress, AWarningIsALineAtOnceAndIsKept) {
  Text out;
  Progress progress({}, {.file = out.file(), .first = milliseconds(60000)});
  progress.step("sum", [&] { progress.warn("a = b\nc: acts elsewhere"); });
  EXPECT_TRUE(out.text().starts_with("wobblebench: warning: a = b\\nc: acts elsewhere\nsum "))
      << out.text();
  EXPECT_EQ(progress.warnings(), std::vector<std::string>{"a = b\\nc: acts elsewhere"});
}

TEST(Progress, AStepThatFailsSaysNothing) {
  Text out;
  Progress progress({}, {.file = out.file(), .first = milliseconds(60000)});
  EXPECT_THROW(progress.step("sum", [] { throw std::runtime_error("expected"); }),
               std::runtime_error);
  EXPECT_EQ(out.text(), "");
  EXPECT_TRUE(progress.steps().empty());
}

}  // namespace
}  // namespace wobblebench::bench
