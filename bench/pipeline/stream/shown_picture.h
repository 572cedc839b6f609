// A picture of a stream, with the times of the echoes in it and of what was done with them.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/pipeline/stream/stream_frame.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// The host's clock throughout.
struct PictureTimes {
  std::uint32_t volume = 0;  ///< of the newest frame
  bool whole = true;         ///< shows one volume; mid-volume pictures show two
  int sticks = 0;            ///< of that volume, so far
  int lost = 0;              ///< sticks that it lacks of the frames so far
  StickTimes first, last;    ///< of that volume: its first stick, and the newest in the picture
  hw::HostTime begun;        ///< pass 1 of the volume's first frame begins
  double update_ms = 0;      ///< pass 1 of the frames since the last picture
  double waited_ms = 0;      ///< since the last picture, for frames
  hw::HostTime complete;     ///< the newest frame was
  hw::HostTime taken;        ///< the newest frame, from the queue
  double pass_1_ms = 0;      ///< of the newest frame
  hw::HostTime uploaded;     ///< pass 1 of the newest frame is done; pass 2 begins
  std::vector<render::PassTime> passes;  ///< 2 to 4
  hw::HostTime ready;
  hw::HostTime written;  ///< the sink is done; ready where the picture was superseded
};

struct ShownPicture {
  PictureTimes times;
  render::Picture picture;
};

}  // namespace wobblebench::bench
