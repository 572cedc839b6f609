#include "bench/pipeline/stream/one_volume.h"

namespace wobblebench::bench {

StreamResult stream_one_volume(const StreamSource& source,
                               StreamRenderer& renderer,
                               const PictureSink& sink) {
  const auto deadline = hw::HostClock::now() + kVolumeTimeout;
  StreamResult result =
      run_stream(source,
                 renderer,
                 {.queue = {.policy = StreamPolicy::every}, .volumes = 1, .keep_volume = true},
                 sink,
                 [&] { return hw::HostClock::now() > deadline; });
  if (!result.kept) throw nothing_came(source.name, "volume", result.reader.ending);
  return result;
}

}  // namespace wobblebench::bench
