// What the live page is sent: binary messages of a header and parts (docs/live.md).
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/evaluation/truth/shadows.h"
#include "bench/live/live_renderer.h"
#include "bench/live/server/live_server.h"
#include "bench/pipeline/stream/stream_queues.h"
#include "hw/wire/account.h"

namespace wobblebench::bench {

/// The picture as JPEG.
LiveMessage picture_message(const LivePicture& shown);

/// True surfaces of one stream's pictures. Used by one thread.
class LiveTruth {
 public:
  explicit LiveTruth(sim::TissueMapSource maps) : maps_(std::move(maps)) {}
  Truth of(const LivePicture& shown);

 private:
  sim::TissueMapSource maps_;
  std::optional<StickReach> still_;  ///< the same in each volume
};

/// Found and true depth of each pixel, its class, the true surface as the renderer shades it, and
/// the error; found depth alone where the scene has no truth.
LiveMessage maps_message(const LivePicture& shown, LiveTruth& truth);

/// B-mode planes of the volume that the picture shows, as JPEG: the middle frame, the plane across
/// frames, and a plane at the middle of the volume of interest's depth.
LiveMessage planes_message(const LivePicture& shown);

/// The picture and, of the same volume, that of the settings at the start, both as JPEG.
LiveMessage compared_message(const LivePicture& shown, const render::Picture& start);

/// A message of what was asked of an earlier volume: `of` is picture, maps or planes, the part that
/// message; no part: the volume is no longer kept.
LiveMessage past_message(std::uint64_t number, const std::string& of, const LiveMessage& message);

/// A frame has come: its number and the lines that were lost.
LiveMessage firing_message(const StreamFrame& frame);

/// Header and parts as docs/live.md says; header.parts is filled in.
LiveMessage binary_message(nlohmann::ordered_json header, const std::vector<std::string>& parts);

/// Times and losses of a stream's picture, number `pictures` of all. `sound_ms`: of a volume; nan,
/// which is null in the message: not known.
LiveMessage times_message(const ShownPicture& shown,
                          std::uint64_t pictures,
                          const hw::BoardAccount& account,
                          const hw::WireDamage& damage,
                          double sound_ms);

}  // namespace wobblebench::bench
