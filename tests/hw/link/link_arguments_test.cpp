#include "hw/link/link_arguments.h"

#include <gtest/gtest.h>

#include "hw/link/xdma_link.h"
#include "hw/recording/file_link.h"
#include "tests/support/expect.h"

namespace wobblebench::hw {
namespace {

TEST(LinkArguments, NameValueAndSettings) {
  const LinkArguments sim = parse_link_arguments("sim");
  EXPECT_EQ(sim.link, "sim");
  EXPECT_TRUE(sim.value.empty());
  EXPECT_TRUE(sim.settings.empty());
  const LinkArguments file = parse_link_arguments("file=a b.wbst,loop=true,pace=realtime");
  EXPECT_EQ(file.link, "file");
  EXPECT_EQ(file.value, "a b.wbst");
  EXPECT_EQ(file.settings.at("loop"), "true");
  EXPECT_EQ(file.settings.at("pace"), "realtime");
}

TEST(LinkArguments, CommaInAPathBelongsToThePath) {
  const LinkArguments file = parse_link_arguments("file=a,b,C=d,1=2.wbst,loop=true");
  EXPECT_EQ(file.value, "a,b,C=d,1=2.wbst");
  EXPECT_EQ(file.settings.size(), 1U);
}

TEST(LinkArguments, RejectsMissingNamesAndRepeatedKeys) {
  for (const char* text : {"", "=x", ",loop=true", "Sim", "si m"}) {
    EXPECT_THROW(parse_link_arguments(text), InvalidOption) << text;
  }
  EXPECT_THROW(parse_link_arguments("sim,pace=asap,pace=asap"), InvalidOption);
}

TEST(LinkSettings, SetDescribedOptions) {
  LinkSettings settings(parse_link_arguments("file=x,loop=true,pace=realtime,start_volume=3"));
  FileLinkOptions options;
  settings.read(options);
  settings.finish("file");
  EXPECT_TRUE(options.loop);
  EXPECT_EQ(options.pace, Pace::realtime);
  EXPECT_EQ(options.start_volume, 3);
  LinkSettings xdma(parse_link_arguments("xdma=/dev/x,busy_patience_ms=250"));
  XdmaLinkOptions device;
  xdma.read(device);
  EXPECT_DOUBLE_EQ(device.busy_patience_s, 0.25);
}

std::string rejection(const std::string& text) {
  return refusal_of<InvalidOption>([&] {
    LinkSettings settings(parse_link_arguments(text));
    FileLinkOptions options;
    settings.read(options);
    settings.finish("file");
  });
}

TEST(LinkSettings, RejectionNamesTheAllowedValues) {
  EXPECT_EQ(rejection("file=x,pace=fast"), "pace = fast: must be one of asap, realtime");
  EXPECT_EQ(rejection("file=x,loop=1"), "loop = 1: must be true or false");
  EXPECT_EQ(rejection("file=x,start_volume=two"),
            "start_volume = two: must be a whole number within 0 and 1073741824");
  EXPECT_EQ(rejection("file=x,start_volume=-1"),
            "start_volume = -1: must be within 0 and 1073741824");
  EXPECT_EQ(rejection("file=x,colour=red"),
            "colour = red: no such key; file takes pace, loop, acquisition, start_volume");
}

}  // namespace
}  // namespace wobblebench::hw
