#include "bench/live/server/live_server.h"

#include <utility>

#include "bench/output/loaded_library.h"

namespace wobblebench::bench {

std::unique_ptr<LiveServer> make_live_server(const ServerOptions& options, ServerCalls calls) {
  using Make = LiveServer* (*)(const ServerOptions&, ServerCalls);
  static const auto make = reinterpret_cast<Make>(function_of_library(
      "wobblebench_live", "wobblebench_make_live_server", "the library of `live` is missing"));
  return std::unique_ptr<LiveServer>(make(options, std::move(calls)));
}

}  // namespace wobblebench::bench
