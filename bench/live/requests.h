// What a live page asks for.
#pragma once

#include <string>

#include "bench/live/live_pipeline.h"
#include "bench/live/panel.h"
#include "bench/live/server/live_server.h"

namespace wobblebench::bench {

/// Answers the messages of pages (docs/live.md): JSON objects, whose key `do` says what. Whatever
/// is wrong with one is told in its answer. Used by the server's thread.
class LiveRequests {
 public:
  /// Both must outlive it. `board`: --board; `renderer`: who renders, for people.
  LiveRequests(LivePanel& panel, LivePipeline& pipeline, std::string board, std::string renderer);

  ServerCalls::Answer take(const std::string& message);

 private:
  nlohmann::ordered_json answer(const nlohmann::json& request, ServerCalls::Answer& to);
  nlohmann::ordered_json hello();
  nlohmann::ordered_json saved() const;
  nlohmann::ordered_json history() const;

  LivePanel& panel_;
  LivePipeline& pipeline_;
  const std::string board_, renderer_;
};

}  // namespace wobblebench::bench
