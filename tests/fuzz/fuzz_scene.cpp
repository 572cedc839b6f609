// Any text as a scene file: read and resolved, or refused in one line.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>

#include "base/file.h"
#include "base/user_error.h"
#include "bench/scene/scene.h"

namespace bench = wobblebench::bench;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const wobblebench::FileDescriptor file(::memfd_create("scene", 0));
  if (!file.is_open() || ::write(file.get(), data, size) != static_cast<ssize_t>(size))
    std::abort();
  const std::string path = "/proc/self/fd/" + std::to_string(file.get());
  try {
    const bench::Scene scene = bench::load_scene(path, {});
    if (bench::resolved(scene).dump().empty()) std::abort();
  } catch (const wobblebench::UserError& error) {
    if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
  }
  return 0;
}
