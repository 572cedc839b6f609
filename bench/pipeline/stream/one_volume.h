// A stream of one volume: the first whose beginning was not missed.
#pragma once

#include "bench/pipeline/stream/stream.h"

namespace wobblebench::bench {

/// For who wants the sticks alone.
class NoRenderer : public StreamRenderer {
 public:
  double add_frame(int, const hw::PolarFrame&) override { return 0; }
  render::Picture render() override { return {}; }
};

/// The volume is `kept` of the result; its picture goes to `sink`. A volume that the end of the
/// stream cut short is one, too, and so is one without its first stick where no other follows:
/// `reader.ending` says that the stream ended. Throws NothingCame if no volume came, and what
/// run_stream() throws.
StreamResult stream_one_volume(
    const StreamSource& source,
    StreamRenderer& renderer,
    const PictureSink& sink = [](const ShownPicture&) {});

}  // namespace wobblebench::bench
